// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Declares the names of toml++ without its parser. Its headers end in .hpp since version 3.4.
#if __has_include(<toml++/impl/forward_declarations.hpp>)
#include <toml++/impl/forward_declarations.hpp>
#else
#include <toml++/impl/forward_declarations.h>
#endif
