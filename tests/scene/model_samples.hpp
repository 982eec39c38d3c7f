// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <string>
#include <string_view>

// One model in every format that Assimp reads for us: a plate of 1 x 2 (corners at 0 0 0, 1 0 0, 1 2 0, 0 2
// 0) of the material "steel" on the node "hull", moved by 3 along x; and again, without a material of its own
// where the format has that, on a node "child" below it: lifted by 0.5, turned by 90 degrees about z after it
// was made twice as long along x. 3DS has the plate only, where it is.
namespace tubefoot {

template <typename Number>
void append_number(std::string& bytes, Number value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

inline std::string collada_model(
    std::string_view asset = R"(<unit name="cm" meter="0.01"/><up_axis>Z_UP</up_axis>)") {
  return R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>)" +
         std::string(asset) + R"(</asset>
<library_effects><effect id="e"><profile_COMMON><technique sid="c"><lambert/></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m" name="steel"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g" name="plate"><mesh><source id="p">
<float_array id="pa" count="12">0 0 0 1 0 0 1 2 0 0 2 0</float_array><technique_common>
<accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist material="ms" count="1"><input semantic="VERTEX" source="#v" offset="0"/><vcount>4</vcount><p>0 1 2 3</p></polylist>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n" name="hull"><translate>3 0 0</translate>
<instance_geometry url="#g"><bind_material><technique_common><instance_material symbol="ms" target="#m"/></technique_common></bind_material></instance_geometry>
<node id="n2" name="child"><translate>0 0 0.5</translate><rotate>0 0 1 90</rotate><scale>2 1 1</scale><instance_geometry url="#g"/></node>
</node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>
)";
}

inline std::string gltf_numbers() {
  std::string bytes;
  for (const float x : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 1.F, 2.F, 0.F, 0.F, 2.F, 0.F}) append_number(bytes, x);
  for (const int corner : {0, 1, 2, 0, 2, 3}) append_number(bytes, static_cast<std::uint16_t>(corner));
  return bytes;
}

/// `buffer`: what its buffer says beside its length; `more`: keys of the whole.
inline std::string gltf_model(const std::string& buffer, const std::string& more = "") {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[
{"name":"hull","translation":[3,0,0],"children":[1],"mesh":0},
{"name":"child","matrix":[0,2,0,0,-1,0,0,0,0,0,1,0,0,0,0.5,1],"mesh":0}],"materials":[{"name":"steel"}],
"meshes":[{"name":"plate","primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,2,0]},
{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],)" +
         more + R"("buffers":[{"byteLength":60)" + buffer + "}]}";
}

inline std::string glb_model() {
  std::string words = gltf_model("");
  words.resize((words.size() + 3) / 4 * 4, ' ');
  const std::string numbers = gltf_numbers();
  std::string bytes = "glTF";
  append_number(bytes, std::uint32_t{2});
  append_number(bytes, static_cast<std::uint32_t>(28 + words.size() + numbers.size()));
  append_number(bytes, static_cast<std::uint32_t>(words.size()));
  bytes += "JSON" + words;
  append_number(bytes, static_cast<std::uint32_t>(numbers.size()));
  return bytes + std::string("BIN\0", 4) + numbers;
}

inline std::string chunk_3ds(std::uint16_t id, const std::string& content) {
  std::string bytes;
  append_number(bytes, id);
  append_number(bytes, static_cast<std::uint32_t>(6 + content.size()));
  return bytes + content;
}

inline std::string studio_model() {
  std::string points, facets, users, version;
  append_number(points, std::uint16_t{4});
  for (const float x : {3.F, 0.F, 0.F, 4.F, 0.F, 0.F, 4.F, 2.F, 0.F, 3.F, 2.F, 0.F}) append_number(points, x);
  append_number(facets, std::uint16_t{2});
  for (const int corner : {0, 1, 2, 7, 0, 2, 3, 7}) append_number(facets, static_cast<std::uint16_t>(corner));
  users = std::string("steel\0", 6);
  for (const int facet : {2, 0, 1}) append_number(users, static_cast<std::uint16_t>(facet));
  append_number(version, std::uint32_t{3});
  return chunk_3ds(
      0x4d4d,
      chunk_3ds(2, version) +
          chunk_3ds(0x3d3d,
                    chunk_3ds(0xafff, chunk_3ds(0xa000, std::string("steel\0", 6))) +
                        chunk_3ds(0x4000,
                                  std::string("hull\0", 5) +
                                      chunk_3ds(0x4100,
                                                chunk_3ds(0x4110, points) +
                                                    chunk_3ds(0x4120, facets + chunk_3ds(0x4130, users))))));
}

inline std::string fbx_model(
    const std::string& settings =
        "\t\tP: \"UpAxis\", \"int\", \"Integer\", \"\",2\n\t\tP: \"UpAxisSign\", \"int\", "
        "\"Integer\", \"\",1\n\t\tP: \"UnitScaleFactor\", \"double\", \"Number\", \"\",100\n") {
  const auto model = [](int id, const char* name, const char* properties) {
    return "\tModel: " + std::to_string(id) + ", \"Model::" + name +
           "\", \"Mesh\" {\n\t\tVersion: 232\n\t\tProperties70:  {\n" + properties + "\t\t}\n\t}\n";
  };
  return "; FBX 7.3.0 project file\nFBXHeaderExtension:  {\n\tFBXHeaderVersion: 1003\n\tFBXVersion: 7300\n}\n"
         "GlobalSettings:  {\n\tVersion: 1000\n\tProperties70:  {\n" +
         settings +
         "\t}\n}\nObjects:  {\n\tGeometry: 100, \"Geometry::plate\", \"Mesh\" {\n\t\tVertices: *12 "
         "{\n\t\t\ta: "
         "0,0,0,1,0,0,1,2,0,0,2,0\n\t\t}\n\t\tPolygonVertexIndex: *4 {\n\t\t\ta: 0,1,2,-4\n\t\t}\n"
         "\t\tGeometryVersion: 124\n\t\tLayerElementMaterial: 0 {\n\t\t\tVersion: 101\n\t\t\tName: \"\"\n"
         "\t\t\tMappingInformationType: \"AllSame\"\n\t\t\tReferenceInformationType: \"IndexToDirect\"\n"
         "\t\t\tMaterials: *1 {\n\t\t\t\ta: 0\n\t\t\t}\n\t\t}\n\t\tLayer: 0 {\n\t\t\tVersion: 100\n"
         "\t\t\tLayerElement:  {\n\t\t\t\tType: \"LayerElementMaterial\"\n\t\t\t\tTypedIndex: "
         "0\n\t\t\t}\n\t\t}\n\t}\n" +
         model(200, "hull", "\t\t\tP: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",3,0,0\n") +
         model(201, "child",
               "\t\t\tP: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",0,0,0.5\n"
               "\t\t\tP: \"Lcl Rotation\", \"Lcl Rotation\", \"\", \"A\",0,0,90\n"
               "\t\t\tP: \"Lcl Scaling\", \"Lcl Scaling\", \"\", \"A\",2,1,1\n") +
         "\tMaterial: 300, \"Material::steel\", \"\" {\n\t\tVersion: 102\n\t\tShadingModel: \"lambert\"\n"
         "\t\tMultiLayer: 0\n\t}\n}\nConnections:  {\n\tC: \"OO\",200,0\n\tC: \"OO\",201,200\n\tC: "
         "\"OO\",100,200\n"
         "\tC: \"OO\",100,201\n\tC: \"OO\",300,200\n\tC: \"OO\",300,201\n}\n";
}

}  // namespace tubefoot
