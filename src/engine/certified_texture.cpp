// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified_texture.hpp"

namespace tubefoot {

std::shared_ptr<const CertifiedTexture> certified_texture(
    const std::shared_ptr<const ReflectivityField>& field) {
  return std::dynamic_pointer_cast<const CertifiedTexture>(field);
}

}  // namespace tubefoot
