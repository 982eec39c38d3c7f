// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Arb, wherever its headers are: it was a library of its own before FLINT 3, and is a part of FLINT since.
#if __has_include(<flint/arb.h>)
#include <flint/acb.h>
#include <flint/arb.h>
#include <flint/arb_hypgeom.h>
#else
#include <acb.h>
#include <arb.h>
#include <arb_hypgeom.h>
#endif
