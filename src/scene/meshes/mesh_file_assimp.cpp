// SPDX-License-Identifier: GPL-3.0-or-later

// Reads COLLADA, glTF, 3DS and FBX with Assimp from bytes in memory, and serialises the model, because the
// code runs in a separate process (mesh_file_apart.hpp). It places all meshes by the transformations of
// their nodes.

#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/material.h>
#include <assimp/mesh.h>
#include <assimp/scene.h>
#include <assimp/version.h>
#include <fmt/core.h>

#include <algorithm>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstring>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <stdexcept>

#include "files/limits.hpp"
#include "scene/meshes/mesh_file_model.hpp"

namespace tubefoot {
namespace {

/// A file system that gives Assimp only the bytes that were read for it.
class GivenFiles final : public Assimp::IOSystem {
 public:
  explicit GivenFiles(const ModelBytes& bytes) : bytes_(bytes) {}

  bool Exists(const char* name) const override { return find(name) != nullptr; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    const std::string* found = find(name);
    if (found == nullptr || std::strchr(mode, 'w') != nullptr) return nullptr;
    return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(found->data()), found->size());
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  const std::string* find(std::string_view name) const {
    while (name.starts_with("./")) name.remove_prefix(2);
    const auto found = bytes_.find(std::string(name));
    return found == bytes_.end() ? nullptr : &found->second;
  }
  const ModelBytes& bytes_;
};

std::string_view importer_of(FileFormat format) {
  switch (format) {
    case FileFormat::collada:
      return "Collada Importer";
    case FileFormat::gltf:
    case FileFormat::gltf_binary:
      return "glTF2 Importer";
    case FileFormat::studio_3ds:
      return "Discreet 3DS Importer";
    default:
      return "Autodesk FBX Importer";
  }
}

/// Removes all importers except one, so that no other sees the bytes. The list does not own the importers.
void keep_only(Assimp::Importer& importer, std::string_view name) {
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;)
    if (importer.GetImporterInfo(i)->mName != name) importer.UnregisterLoader(importer.GetImporter(i));
  if (importer.GetImporterCount() != 1)
    throw std::runtime_error("the Assimp library has no '" + std::string(name) + "'");
}

glm::dmat4 matrix(const aiMatrix4x4& m) {
  glm::dmat4 result;
  for (unsigned row = 0; row < 4; ++row)
    for (unsigned column = 0; column < 4; ++column)
      result[static_cast<int>(column)][static_cast<int>(row)] = static_cast<double>(m[row][column]);
  return result;
}

class Gathered {
 public:
  /// `bytes` is the size of the model.
  Gathered(const aiScene& scene, std::uint64_t bytes)
      : scene_(scene), most_(bytes + limits::model_repeated), size_of_(scene.mNumMeshes) {
    for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
      size_of_[i] = scene.mMeshes[i]->mNumVertices;
      for (unsigned f = 0; f < scene.mMeshes[i]->mNumFaces; ++f)
        size_of_[i] += scene.mMeshes[i]->mFaces[f].mNumIndices;
    }
  }

  /// `own_root` states that Assimp itself chose the rotation and scale of the root, so that they are
  /// ignored.
  Model gather(bool own_root) {
    struct Visit {
      const aiNode* node;
      glm::dmat4 to_model;
    };
    const aiNode* root = scene_.mRootNode;
    if (root == nullptr) throw std::runtime_error("it has no nodes");
    std::vector<Visit> left{{root, own_root ? glm::dmat4(1) : matrix(root->mTransformation)}};
    while (!left.empty()) {
      const Visit visit = left.back();
      left.pop_back();
      for (unsigned i = 0; i < visit.node->mNumMeshes; ++i) {
        const unsigned mesh = visit.node->mMeshes[i];
        if (mesh >= scene_.mNumMeshes) throw std::runtime_error("a node refers to a missing mesh");
        placed_ += size_of_[mesh];
        if (placed_ > most_)
          throw std::runtime_error(
              fmt::format("its nodes place more than {} vertices and corners, too many for its size", most_));
        add(*scene_.mMeshes[mesh], *visit.node, visit.to_model);
      }
      for (unsigned i = visit.node->mNumChildren; i-- > 0;) {
        const aiNode* child = visit.node->mChildren[i];
        left.push_back({child, visit.to_model * matrix(child->mTransformation)});
      }
    }
    if (deformed_ > 0)
      model_.polygons.warnings.push_back(std::to_string(deformed_) +
                                         " meshes are attached to bones: tubefoot reads their original "
                                         "shapes, without the effect of the bones");
    return std::move(model_);
  }

 private:
  void add(const aiMesh& mesh, const aiNode& node, const glm::dmat4& to_model) {
    UncheckedPolygons& polygons = model_.polygons;
    const std::size_t first = polygons.points.size();
    if (first + mesh.mNumVertices >= std::numeric_limits<std::uint32_t>::max())
      throw std::runtime_error("it has more than 2^32 vertices");
    if (mesh.mNumBones > 0) ++deformed_;
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D& p = mesh.mVertices[v];
      polygons.points.emplace_back(to_model * glm::dvec4(p.x, p.y, p.z, 1));
    }
    const auto names = static_cast<std::uint32_t>(polygons.names.size());
    polygons.names.push_back(names_of(mesh, node));
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      for (unsigned k = 0; k < face.mNumIndices; ++k) {
        if (face.mIndices[k] >= mesh.mNumVertices)
          throw std::runtime_error("a face refers to a missing vertex");
        polygons.corners.push_back(static_cast<std::uint32_t>(first + face.mIndices[k]));
      }
      polygons.end_polygon();
      polygons.names_of.push_back(names);
    }
  }

  std::vector<std::string> names_of(const aiMesh& mesh, const aiNode& node) const {
    std::vector<std::string> names;
    const auto add = [&names](const aiString& name) {
      const std::string text(name.data, std::min<std::size_t>(name.length, sizeof name.data));
      // Assimp creates these nodes for the pivots of an FBX.
      if (text.find("_$AssimpFbx$") == text.npos && !text.empty() &&
          std::ranges::find(names, text) == names.end())
        names.push_back(text);
    };
    // Assimp gives its own material to meshes without one.
    if (mesh.mMaterialIndex < scene_.mNumMaterials)
      if (const aiString name = scene_.mMaterials[mesh.mMaterialIndex]->GetName();
          std::strcmp(name.C_Str(), AI_DEFAULT_MATERIAL_NAME) != 0)
        add(name);
    add(mesh.mName);
    constexpr int most_parents = 64;
    const aiNode* around = &node;
    for (int i = 0; around != nullptr && i < most_parents; ++i, around = around->mParent) add(around->mName);
    return names;
  }

  const aiScene& scene_;
  std::uint64_t most_, placed_ = 0;
  std::vector<std::uint64_t> size_of_;  ///< vertices and corners, by mesh
  Model model_;
  std::size_t deformed_ = 0;
};

template <typename T>
std::optional<T> told(const aiScene& scene, const char* key) {
  T value{};
  if (scene.mMetaData != nullptr && scene.mMetaData->Get(key, value)) return value;
  return std::nullopt;
}

/// Returns whether the file states a property. Assimp reports defaults as if the file contained them, so
/// that the bytes decide.
bool says(std::string_view content, std::string_view property) {
  for (std::size_t at = content.find(property); at != content.npos; at = content.find(property, at + 1)) {
    // "OriginalUpAxis" and "UpAxisSign" are other properties. The length of a name, or a quote, precedes
    // the name.
    const auto is_letter = [&](std::size_t i) {
      return i < content.size() && std::isalpha(static_cast<unsigned char>(content[i])) != 0;
    };
    if (!(at > 0 && is_letter(at - 1)) && !is_letter(at + property.size())) return true;
  }
  return false;
}

void declare_fbx(const aiScene& scene, std::string_view content, DeclaredAxes& declared) {
  const int axis = told<std::int32_t>(scene, "UpAxis").value_or(-1),
            sign = told<std::int32_t>(scene, "UpAxisSign").value_or(1);
  if (says(content, "UpAxis") && axis >= 0 && axis <= 2 && sign == 1)
    declared.up = std::string(1, "xyz"[axis]);
  double centimetres = told<double>(scene, "UnitScaleFactor").value_or(0);
  if (centimetres == 0) centimetres = static_cast<double>(told<float>(scene, "UnitScaleFactor").value_or(0));
  if (says(content, "UnitScaleFactor") && centimetres > 0 && std::isfinite(centimetres))
    declared.unit_m = centimetres / 100;
}

// --- a model as bytes ---

template <typename T>
void put(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}
template <typename T>
void put_all(std::string& bytes, const std::vector<T>& values) {
  put(bytes, values.size());
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}
void put_text(std::string& bytes, const std::string& text) {
  put_all(bytes, std::vector<char>(text.begin(), text.end()));
}

class Taken {
 public:
  explicit Taken(std::string_view bytes) : bytes_(bytes) {}
  template <typename T>
  T one() {
    T value{};
    std::memcpy(&value, raw(sizeof value), sizeof value);
    return value;
  }
  template <typename T>
  std::vector<T> all() {
    const auto count = one<std::size_t>();
    if (count > bytes_.size() / sizeof(T)) throw std::runtime_error("the data are cut off");
    std::vector<T> values(count);
    if (count > 0) std::memcpy(static_cast<void*>(values.data()), raw(count * sizeof(T)), count * sizeof(T));
    return values;
  }
  std::string text() {
    const std::vector<char> letters = all<char>();
    return {letters.begin(), letters.end()};
  }
  /// Reads as many items as a count states. Each item has at least 8 bytes.
  template <typename Read>
  void each(Read read) {
    const auto count = one<std::size_t>();
    if (count > bytes_.size() / sizeof(std::size_t)) throw std::runtime_error("the data are cut off");
    for (std::size_t i = 0; i < count; ++i) read();
  }

 private:
  const char* raw(std::size_t count) {
    if (count > bytes_.size()) throw std::runtime_error("the data are cut off");
    const char* const here = bytes_.data();
    bytes_.remove_prefix(count);
    return here;
  }
  std::string_view bytes_;
};

std::string as_bytes(const Model& model) {
  const UncheckedPolygons& polygons = model.polygons;
  std::string bytes;
  put_text(bytes, model.declared.up.value_or(""));
  put(bytes, model.declared.unit_m.value_or(0));
  put_all(bytes, polygons.points);
  put_all(bytes, polygons.corners);
  put_all(bytes, polygons.end);
  put_all(bytes, polygons.names_of);
  put(bytes, polygons.names.size());
  for (const std::vector<std::string>& names : polygons.names) {
    put(bytes, names.size());
    for (const std::string& name : names) put_text(bytes, name);
  }
  put(bytes, polygons.warnings.size());
  for (const std::string& warning : polygons.warnings) put_text(bytes, warning);
  return bytes;
}

}  // namespace

Model model_from(const std::string& bytes) {
  Taken taken(bytes);
  Model model;
  UncheckedPolygons& polygons = model.polygons;
  if (const std::string up = taken.text(); up == "x" || up == "y" || up == "z") model.declared.up = up;
  if (const auto unit_m = taken.one<double>(); unit_m > 0) model.declared.unit_m = unit_m;
  polygons.points = taken.all<glm::dvec3>();
  polygons.corners = taken.all<std::uint32_t>();
  polygons.end = taken.all<std::size_t>();
  polygons.names_of = taken.all<std::uint32_t>();
  taken.each([&] {
    auto& names = polygons.names.emplace_back();
    taken.each([&] { names.push_back(taken.text()); });
  });
  taken.each([&] { polygons.warnings.push_back(taken.text()); });
  // The process that wrote the bytes may have failed after reading.
  std::size_t before = 0;
  for (const std::size_t end : polygons.end) {
    if (end < before || end > polygons.corners.size())
      throw std::runtime_error("the polygons are out of order");
    before = end;
  }
  const auto has_names = [&](std::uint32_t names) { return names < polygons.names.size(); };
  if (polygons.names_of.size() != polygons.end.size() || !std::ranges::all_of(polygons.names_of, has_names))
    throw std::runtime_error("the names are out of order");
  return model;
}

void load_assimp() { aiGetVersionMajor(); }

std::string assimp_model(const ModelBytes& bytes, const std::string& name, FileFormat format) {
  Assimp::Importer importer;
  keep_only(importer, importer_of(format));
  importer.SetIOHandler(new GivenFiles(bytes));
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  for (const char* not_read : {AI_CONFIG_IMPORT_FBX_READ_ANIMATIONS, AI_CONFIG_IMPORT_FBX_READ_CAMERAS,
                               AI_CONFIG_IMPORT_FBX_READ_LIGHTS, AI_CONFIG_IMPORT_FBX_READ_TEXTURES})
    importer.SetPropertyBool(not_read, false);
  const aiScene* scene = importer.ReadFile(name, 0);
  if (scene == nullptr) throw std::runtime_error(importer.GetErrorString());
  std::uint64_t size = 0;
  for (const auto& [part, content] : bytes) size += content.size();
  Model model =
      Gathered(*scene, size).gather(format == FileFormat::collada || format == FileFormat::studio_3ds);
  if (format == FileFormat::fbx) declare_fbx(*scene, bytes.at(name), model.declared);
  if (const aiNode* root = scene->mRootNode;
      format == FileFormat::studio_3ds && std::abs(root->mTransformation.a1) != 1)
    model.polygons.warnings.push_back(
        "its master scale is not 1, but tubefoot does not use it: 'unit_m' applies to its coordinates");
  return as_bytes(model);
}

}  // namespace tubefoot
