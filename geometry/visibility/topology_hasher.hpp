// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <boost/multiprecision/gmp.hpp>

#include "geometry/mesh/facet_cone.hpp"
#include "geometry/visibility/closure.hpp"

// Expensive to compile: include it only in .cpp files.
namespace tubefoot {

/// The hash of a sequence of words, integers and facets.
class TopologyHasher {
 public:
  void add(std::uint64_t word) {
    hash_.high = mix(hash_.high * 0x9e3779b97f4a7c15u + word + 0x632be59bd9b4e019u);
    hash_.low = mix(hash_.low + 0xd1b54a32d192ed03u * (word ^ (hash_.high >> 7)));
  }
  void add(const boost::multiprecision::mpz_int& integer) {
    const auto* z = integer.backend().data();
    const std::size_t limbs = mpz_size(z);
    add(limbs * 2 + (mpz_sgn(z) < 0));
    for (std::size_t k = 0; k < limbs; ++k) add(mpz_getlimbn(z, static_cast<mp_size_t>(k)));
  }
  /// Adds a facet by its corners relative to the apex, independently of their order.
  void add(const FacetMesh& mesh, FacetId facet, GridPoint apex) {
    std::array<GridPoint, 3> key;
    for (int k = 0; k < 3; ++k) key[k] = mesh.vertices[mesh.facets[facet][k]] - apex;
    std::sort(key.begin(), key.end());
    for (const GridPoint& p : key)
      for (const std::int32_t c : {p.x, p.y, p.z})
        add(static_cast<std::uint64_t>(static_cast<std::int64_t>(c)));
  }
  TopologyHash get() const { return hash_; }

 private:
  static std::uint64_t mix(std::uint64_t x) {  // finaliser of splitmix64
    x ^= x >> 30;
    x *= 0xbf58476d1ce4e5b9u;
    x ^= x >> 27;
    x *= 0x94d049bb133111ebu;
    return x ^ (x >> 31);
  }
  TopologyHash hash_;
};

}  // namespace tubefoot
