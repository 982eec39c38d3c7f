// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Includes Arb. Arb was a separate library before FLINT 3 and has been a part of FLINT since then.
#if __has_include(<flint/arb.h>)
#include <flint/acb.h>
#include <flint/arb.h>
#include <flint/arb_hypgeom.h>
#else
#include <acb.h>
#include <arb.h>
#include <arb_hypgeom.h>
#endif
