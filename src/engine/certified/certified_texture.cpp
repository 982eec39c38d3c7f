// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/certified/certified_texture.hpp"

#include "engine/certified/certified_map.hpp"
#include "engine/certified/certified_perlin.hpp"
#include "engine/scattering/layered_reflectivity.hpp"

// Creates certified textures from reflectivity fields: Perlin noise, maps, and products of them. The axes of
// a product are the axes of its layers.
namespace tubefoot {
namespace {

/// Product of textures. Its axes are those of the layers, one after the other.
class CertifiedProduct : public CertifiedTexture {
 public:
  explicit CertifiedProduct(std::vector<std::shared_ptr<const CertifiedTexture>> layers)
      : layers_(std::move(layers)) {
    for (const auto& layer : layers_) {
      const std::vector<Axis> axes = layer->axes();
      axes_.insert(axes_.end(), axes.begin(), axes.end());
      counts_.push_back(axes.size());
    }
  }

  std::vector<Axis> axes() const override { return axes_; }

  Ball factor(std::span<const std::int64_t> cell, std::span<const Ball> q) const override {
    Ball product(1);
    each(cell, q, [&](const auto& layer, auto own_cell, auto own_q) {
      product = product * layer.factor(own_cell, own_q);
    });
    return product;
  }
  Interval factor(std::span<const std::int64_t> cell, std::span<const Interval> q) const override {
    Interval product(1);
    each(cell, q, [&](const auto& layer, auto own_cell, auto own_q) {
      product = product * layer.factor(own_cell, own_q);
    });
    return product;
  }

  double largest(std::span<const std::int64_t> cell, std::span<const ComplexBall> q) const override {
    double product = 1;
    each(cell, q,
         [&](const auto& layer, auto own_cell, auto own_q) { product *= layer.largest(own_cell, own_q); });
    return product * (1 + 1e-12);
  }

  double difference(double off) const override {
    // The factors of each layer may have an error of the layer's own difference, both within the cell and
    // outside of it.
    return 2 * more_by([&](const CertifiedTexture& layer) { return layer.difference(off); });
  }

  double change(double off) const override {
    return more_by([&](const CertifiedTexture& layer) { return layer.change(off); });
  }

  Ball range() const override {
    Ball product(1);
    for (const auto& layer : layers_) product = product * layer->range();
    return product;
  }

 private:
  /// Bounds the growth of the product if the factor of each layer grows by `more(layer)`.
  template <class More>
  double more_by(const More& more) const {
    Ball with(1), without(1);
    for (const auto& layer : layers_) {
      const Ball largest(layer->range().hi());
      with = with * (largest + Ball(more(*layer)));
      without = without * largest;
    }
    return (with - without).hi();
  }

  template <class N, class Take>
  void each(std::span<const std::int64_t> cell, std::span<const N> q, const Take& take) const {
    std::size_t first = 0;
    for (std::size_t k = 0; k < layers_.size(); first += counts_[k], ++k)
      take(*layers_[k], cell.subspan(first, counts_[k]), q.subspan(first, counts_[k]));
  }

  std::vector<std::shared_ptr<const CertifiedTexture>> layers_;
  std::vector<Axis> axes_;
  std::vector<std::size_t> counts_;  // number of axes of each layer
};

}  // namespace

Interval CertifiedTexture::factor(std::span<const std::int64_t> cell, std::span<const Interval> q) const {
  std::vector<Ball> balls;
  for (const Interval& x : q) balls.push_back(Ball::between(x.lo, x.hi));
  const Ball value = factor(cell, balls);
  return {value.lo(), value.hi()};
}

std::shared_ptr<const CertifiedTexture> certified_texture(
    const std::shared_ptr<const ReflectivityField>& field) {
  if (const auto perlin = std::dynamic_pointer_cast<const PerlinReflectivity>(field))
    return std::make_shared<CertifiedPerlin>(*perlin);
  if (const auto map = std::dynamic_pointer_cast<const MapReflectivity>(field))
    return std::make_shared<CertifiedMap>(map);
  if (const auto layered = std::dynamic_pointer_cast<const LayeredReflectivity>(field)) {
    std::vector<std::shared_ptr<const CertifiedTexture>> layers;
    for (const auto& layer : layered->layers()) {
      layers.push_back(certified_texture(layer));
      if (layers.back() == nullptr) return nullptr;
    }
    return std::make_shared<CertifiedProduct>(std::move(layers));
  }
  return nullptr;
}

}  // namespace tubefoot
