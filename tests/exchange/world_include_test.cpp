// SPDX-License-Identifier: GPL-3.0-or-later
// Tests included models of SDF worlds: their places, names and frames, and the files that they may read.
// Models that include each other end.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include "exchange/readers/scene_readers.hpp"
#include "files/input_error.hpp"
#include "fixtures/program.hpp"
#include "fixtures/test_folder.hpp"

namespace tubefoot {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

struct Includes : testing::Test {
  TestFolder folder;

  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder / name).parent_path());
    folder.write(name, text);
  }
  /// Writes models/NAME/model.sdf with a <model> of that name.
  void write_model(const std::string& name, const std::string& inside,
                   const std::string& attributes = "") const {
    write("models/" + name + "/model.sdf",
          "<sdf version='1.9'><model name='" + name + "' " + attributes + ">" + inside + "</model></sdf>");
  }
  ImportedScene world(const std::string& inside) const {
    write("worlds/w.sdf", "<sdf version='1.9'><world name='w'>" + inside + "</world></sdf>");
    return read_world(folder / "worlds/w.sdf", {folder / "models"});
  }
};

const std::string stone =
    "<visual name='v'><geometry><sphere><radius>1</radius></sphere></geometry></visual>";
const std::string ground = "<model name='ground'><link name='l'>" + stone + "</link></model>";

std::string link_at(const std::string& pose, const std::string& name = "l") {
  return "<link name='" + name + "'><pose>" + pose + "</pose>" + stone + "</link>";
}
std::string include_of(const std::string& uri, const std::string& inside = "") {
  return "<include><uri>" + uri + "</uri>" + inside + "</include>";
}

TEST_F(Includes, PlaceModelsInModels) {
  // As in Worlds.PutPosesIntoPoses: turned by 90 degrees at (10, 0, 0), then (1, 0, 0), (0, 1, 0), (0, 0, 1).
  write_model("inner",
              "<link name='l'><pose>0 1 0 0 0 0</pose><visual name='v'><pose>0 0 1 0 0 0</pose>"
              "<geometry><sphere/></geometry></visual></link>");
  write_model("outer", include_of("model://inner", "<pose>1 0 0 0 0 0</pose>"));
  const ImportedScene scene = world(include_of(
      " model://outer\n", "<name>tug</name><pose degrees='true'>10 0 0 0 0 90</pose><static>true</static>"));
  ASSERT_EQ(scene.objects.size(), 1);
  EXPECT_EQ(scene.objects[0].name, "tug::inner::l::v");
  EXPECT_LT(glm::length(scene.objects[0].placed.position_m - glm::dvec3(9, 1, 1)), 1e-14);
  EXPECT_EQ(scene.inputs.size(), 2);
}

// A law: an <include> gives the same scene as the text of its model in its place.
TEST_F(Includes, EqualTheTextOfTheirModel) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-3, 3);
  const auto pose = [&] {
    return fmt::format("<pose>{} {} {} {} {} {}</pose>", number(random), number(random), number(random),
                       number(random), number(random), number(random));
  };
  for (int k = 0; k < 50; ++k) {
    const std::string name = fmt::format("m{}", k), own = pose(), given = pose();
    const std::string inside = "<frame name='f'>" + pose() + "</frame><link name='a'>" + pose() + stone +
                               "</link><model name='n'>" + pose() + "<link name='b'>" + pose() +
                               "<visual name='v'>" + pose() +
                               "<geometry><box/></geometry></visual></link></model>";
    write_model(name, own + inside);
    const auto inlined = [&](const std::string& at) {
      return scene_text(world("<model name='" + name + "'>" + at + inside + "</model>"));
    };
    EXPECT_EQ(scene_text(world(include_of("model://" + name))), inlined(own));
    EXPECT_EQ(scene_text(world(include_of("model://" + name, given))), inlined(given));
  }
}

TEST_F(Includes, MayBePlacedByAFrameOfTheModel) {
  write_model("buoy", link_at("0 0 2 0 0 1.5707963267948966") +
                          "<frame name='top' attached_to='l'><pose>1 0 0 0 0 0</pose></frame>");
  for (const auto& [frame, expected] :
       {std::pair("l", glm::dvec3(5, 6, 7)), std::pair("top", glm::dvec3(4, 6, 7))}) {
    const ImportedScene scene =
        world(include_of("model://buoy", std::string("<pose>5 6 7 0 0 0</pose><placement_frame>") + frame +
                                             "</placement_frame>"));
    ASSERT_EQ(scene.objects.size(), 1);
    EXPECT_LT(glm::length(scene.objects[0].placed.position_m - expected), 1e-14) << frame;
    // The chosen frame has the axes of the world, so the link has them too.
    EXPECT_LT(glm::length(scene.objects[0].placed.turn[0] - glm::dvec3(1, 0, 0)), 1e-14);
  }
  // The attribute of a model does the same.
  write_model("mast", link_at("0 0 2 0 0 0"), "placement_frame='l'");
  EXPECT_EQ(world(include_of("model://mast", "<pose>5 6 7 0 0 0</pose>")).objects.at(0).placed.position_m,
            glm::dvec3(5, 6, 7));
  EXPECT_THAT(
      world(include_of("model://buoy", "<pose>0 0 0 0 0 0</pose><placement_frame>x</placement_frame>") +
            ground)
          .noticed,
      Contains(HasSubstr("'buoy' is left out: it has no frame 'x' to be placed at")));
}

TEST_F(Includes, HaveFramesThatOthersReferTo) {
  write_model("arm", link_at("0 0 1 0 0 0", "base") + link_at("0 0 3 0 0 0", "hand") +
                         "<joint name='wrist' type='fixed'><pose>0 1 0 0 0 0</pose><parent>base</parent>"
                         "<child>hand</child></joint>");
  const auto at = [&](const std::string& frame, const std::string& attributes = "") {
    const ImportedScene scene =
        world("<include " + attributes + "><uri>model://arm</uri><pose>10 0 0 0 0 0</pose></include>" +
              "<model name='m'><pose relative_to='" + frame + "'>1 0 0 0 0 0</pose>" +
              link_at("0 0 0 0 0 0") + "</model>");
    return scene.objects.size() == 3 ? scene.objects[2].placed.position_m : glm::dvec3(-1);
  };
  EXPECT_EQ(at("arm"), glm::dvec3(11, 0, 0));
  EXPECT_EQ(at("arm::hand"), glm::dvec3(11, 0, 3));
  EXPECT_EQ(at("arm::wrist"), glm::dvec3(11, 1, 3));
  EXPECT_EQ(at("arm::none"), glm::dvec3(-1));
  // The children of a merged model belong to its parent.
  EXPECT_EQ(at("hand", "merge='true'"), glm::dvec3(11, 0, 3));
  EXPECT_EQ(world("<model name='m'><include merge='true'><uri>model://arm</uri></include></model>")
                .objects.at(0)
                .name,
            "m::base::v");
  // A visual may be placed by a frame of its model.
  write_model("eye", link_at("0 0 1 0 0 0", "base") +
                         "<link name='l'><visual name='v'><pose relative_to='base'>0 2 0 0 0 0</pose>"
                         "<geometry><sphere/></geometry></visual></link>");
  EXPECT_EQ(world(include_of("model://eye")).objects.at(1).placed.position_m, glm::dvec3(0, 2, 1));
}

TEST_F(Includes, ThatDependOnEachOtherEnd) {
  write_model("self", link_at("0 0 0 0 0 0") + include_of("model://self"));
  write_model("a", include_of("model://b") + link_at("0 0 0 0 0 0"));
  write_model("b", include_of("model://a") + link_at("0 0 0 0 0 0"));
  const ImportedScene scene = world(include_of("model://self") + include_of("model://a"));
  EXPECT_EQ(scene.objects.size(), 3);
  EXPECT_THAT(scene.noticed, Contains(HasSubstr("'model://self' is left out: the model includes itself")));
  EXPECT_THAT(scene.noticed, Contains(HasSubstr("'model://a' is left out: the model includes itself")));
  for (int k = 0; k < 30; ++k)
    write_model(fmt::format("deep{}", k),
                link_at("0 0 0 0 0 0") + include_of(fmt::format("model://deep{}", k + 1)));
  const ImportedScene deep = world(include_of("model://deep0"));
  EXPECT_EQ(deep.objects.size(), 16);
  EXPECT_THAT(deep.noticed, Contains(HasSubstr("more than 16 levels")));
  // Each of ten models includes the next one ten times.
  for (int k = 0; k < 10; ++k) {
    std::string next;
    for (int n = 0; n < 10; ++n) next += include_of(fmt::format("model://many{}", k + 1));
    write_model(fmt::format("many{}", k), next + link_at("0 0 0 0 0 0"));
  }
  write_model("many10", link_at("0 0 0 0 0 0"));
  EXPECT_THAT([&] { world(include_of("model://many0")); },
              testing::ThrowsMessage<InputError>(HasSubstr("more than 10000 <include>")));
  // A chain of frames, each relative to the next one, does not exhaust the stack.
  std::string chain;
  for (int k = 0; k < 20'000; ++k) chain += fmt::format("<frame name='f{}' attached_to='f{}'/>", k, k + 1);
  EXPECT_THAT(
      world(chain + "<model name='m'><pose relative_to='f0'/>" + link_at("0 0 0 0 0 0") + "</model>" + ground)
          .noticed,
      Contains(HasSubstr("relative to 'f0'")));
}

TEST_F(Includes, ThatCannotBeReadAreReportedByName) {
  write("models/torn/model.sdf", "<sdf version='1.9'><model name='torn'>");
  write("models/hollow/model.config", "<model><sdf version='1.6'>gone.sdf</sdf></model>");
  write("models/lamp/model.sdf", "<sdf version='1.6'><light name='lamp' type='point'/></sdf>");
  write("models/diver/model.sdf", "<sdf version='1.6'><actor name='diver'/></sdf>");
  write_model("fish", "<link name='l'><pose>1 2</pose>" + stone + "</link>");
  const ImportedScene scene =
      world(ground + include_of("model://torn") + include_of("model://hollow") + include_of("model://lamp") +
            include_of("model://diver") + include_of("model://nowhere") + include_of("") +
            include_of("https://fuel.gazebosim.org/1.0/Someone/models/Sand%20Heightmap"));
  EXPECT_EQ(scene.objects.size(), 1);
  for (const char* told :
       {"'model://torn' is left out: ", "torn/model.sdf:1:", "contains no 'gone.sdf'",
        "'model://diver' is left out: it is a <actor>", "'model://nowhere' is left out: there is no such",
        "'' is left out: it does not name a file",
        "model 'Sand Heightmap' of Gazebo Fuel is not on this computer", "1 x <light>"})
    EXPECT_THAT(scene.noticed, Contains(HasSubstr(told)));
  // An error inside of a model names its file.
  EXPECT_THAT([&] { world(include_of("model://fish")); },
              testing::ThrowsMessage<InputError>(
                  AllOf(HasSubstr("fish/model.sdf:1:"), HasSubstr("there are 2 numbers"))));
  // Without a model path, the message names the folder beside that of the worlds.
  write("worlds/w.sdf",
        "<sdf version='1.9'><world name='w'>" + ground + include_of("model://fish") + "</world></sdf>");
  EXPECT_THAT(read_world(folder / "worlds/w.sdf", {}).noticed,
              Contains(AllOf(HasSubstr("--model-path"), HasSubstr((folder / "models").string()))));
}

TEST_F(Includes, ReadTheNewestVersionOfAModel) {
  const auto model = [](const std::string& z) {
    return "<sdf version='1.6'><model name='m'>" + link_at("0 0 " + z + " 0 0 0") + "</model></sdf>";
  };
  write("models/m/old.sdf", model("4"));
  write("models/m/new.sdf", model("10"));
  write("models/m/model.sdf", model("1"));
  write("models/m/model.config",
        "<model><name>m</name><sdf version='1.10'>new.sdf</sdf>"
        "<sdf version='1.4'>old.sdf</sdf></model>");
  EXPECT_EQ(world(include_of("model://m")).objects.at(0).placed.position_m.z, 10);
  fs::remove(folder / "models/m/model.config");
  EXPECT_EQ(world(include_of("model://m")).objects.at(0).placed.position_m.z, 1);
  // A path to a file, relative to the file that names it, and a name without a scheme.
  write("worlds/near.sdf", model("7"));
  EXPECT_EQ(world(include_of("near.sdf")).objects.at(0).placed.position_m.z, 7);
  EXPECT_EQ(world(include_of("m")).objects.at(0).placed.position_m.z, 1);
}

TEST_F(Includes, MayNameAFileThatIncludesAModel) {
  write_model("rock", "<pose>0 0 1 0 0 0</pose>" + link_at("0 0 0 0 0 0"));
  const auto alias = [&](const std::string& inside) {
    write("models/alias/model.sdf", "<sdf version='1.7'>" + include_of("model://rock", inside) + "</sdf>");
  };
  alias("");
  EXPECT_EQ(world(include_of("model://alias")).objects.at(0).placed.position_m.z, 1);
  alias("<name>stone</name><pose>0 0 2 0 0 0</pose>");
  const ImportedScene scene = world(include_of("model://alias"));
  EXPECT_EQ(scene.objects.at(0).placed.position_m.z, 2);
  EXPECT_EQ(scene.objects.at(0).name, "stone::l::v");
  EXPECT_EQ(world(include_of("model://alias", "<pose>0 0 3 0 0 0</pose>")).objects.at(0).placed.position_m.z,
            3);
  // A file that names itself, directly or by another one, ends.
  write("models/alias/model.sdf", "<sdf version='1.7'>" + include_of("model://echo") + "</sdf>");
  write("models/echo/model.sdf", "<sdf version='1.7'>" + include_of("model://alias") + "</sdf>");
  EXPECT_THAT(world(ground + include_of("model://alias")).noticed,
              Contains(HasSubstr("the file includes itself")));
}

TEST_F(Includes, FindModelsOfFuelInACopyOfItsCache) {
  const auto model = [](const std::string& z) {
    return "<sdf version='1.6'><model name='m'>" + link_at("0 0 " + z + " 0 0 0") + "</model></sdf>";
  };
  const std::string fuel = include_of("https://fuel.gazebosim.org/1.0/OpenRobotics/models/Coast Water");
  const std::string cached = "models/fuel.gazebosim.org/openrobotics/models/coast water/";
  write(cached + "2/model.sdf", model("2"));
  write(cached + "10/model.sdf", model("10"));
  write("models/Coast Water/model.sdf", model("5"));
  EXPECT_EQ(world(fuel).objects.at(0).placed.position_m.z, 10);
  fs::remove_all(folder / "models/fuel.gazebosim.org");
  EXPECT_EQ(world(fuel).objects.at(0).placed.position_m.z, 5);
}

TEST_F(Includes, FindTheMeshesOfTheirOwnFolder) {
  constexpr std::string_view triangle = "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n";
  write("models/rock/meshes/rock.obj", std::string(triangle));
  for (const char* uri : {"meshes/rock.obj", "model://rock/meshes/rock.obj", "file://meshes/rock.obj"}) {
    const std::string mesh = std::string("<link name='l'><visual name='v'><geometry><mesh><uri>") + uri +
                             "</uri></mesh></geometry></visual></link>";
    write_model("rock", mesh);
    EXPECT_EQ(world(include_of("model://rock")).meshes.size(), 1) << uri;
    // The model itself may be imported, without a model path.
    EXPECT_EQ(read_world(folder / "models/rock/model.sdf", {}).meshes.size(), 1) << uri;
  }
}

TEST_F(Includes, ReadNoModelOutsideOfTheFolders) {
  TestFolder elsewhere;
  elsewhere.write("model.sdf",
                  "<sdf version='1.6'><model name='m'>" + link_at("0 0 0 0 0 0") + "</model></sdf>");
  fs::create_directories(folder / "models/config");
  fs::create_symlink(elsewhere.path(), folder / "models/link");
  const std::string up = fs::relative(elsewhere / "model.sdf", folder / "models/config").string();
  write("models/config/model.config", "<model><sdf version='1.6'>" + up + "</sdf></model>");
  const std::string from_worlds = fs::relative(elsewhere / "model.sdf", folder / "worlds").string();
  for (const std::string& uri :
       {std::string("model://link"), std::string("model://config"), elsewhere.path().string(), from_worlds,
        "file://" + (elsewhere / "model.sdf").string(), "model://../" + from_worlds}) {
    const ImportedScene scene = world(ground + include_of(uri));
    EXPECT_EQ(scene.objects.size(), 1) << uri;
    EXPECT_THAT(scene.noticed, Contains(HasSubstr("<include> of '"))) << uri;
  }
}

TEST_F(Includes, ThatAreDamagedAreRefusedOrRead) {
  const std::string place = "<pose relative_to='arm::j'>1 2 3 0 0 0</pose>";
  const std::string whole[] = {
      "<sdf version='1.9'><world name='w'>" + ground +
          include_of("model://arm", "<pose>1 0 0 0 0 0</pose><placement_frame>n::l</placement_frame>") +
          "<include merge='true'><uri>model://arm</uri></include>" + "<model name='m'>" + place +
          link_at("0 0 0 0 0 0") + "</model></world></sdf>",
      "<sdf version='1.9'><model name='arm' placement_frame='f'><frame name='f' attached_to='l'/>" +
          link_at("0 0 1 0 0 0") + "<joint name='j'><child>l</child></joint><model name='n'>" +
          link_at("0 0 1 0 0 0") + "</model></model></sdf>"};
  std::mt19937 random(11);
  const auto below = [&](std::size_t end) { return random() % end; };
  std::size_t read = 0;
  for (int k = 0; k < 2000; ++k) {
    std::string texts[] = {whole[0], whole[1]};
    for (std::size_t damage = 1 + below(3); damage > 0; --damage) {
      std::string& text = texts[below(2)];
      const std::size_t at = below(text.size());
      switch (below(3)) {
        case 0:
          text[at] = static_cast<char>(below(256));
          break;
        case 1:
          text.erase(at, 1 + below(8));
          break;
        default:
          text.insert(
              at, std::array{"9e99", "::", "&#0;", "<include>", "'", "model://arm", "f", "\xff"}[below(8)]);
      }
    }
    write("worlds/d.sdf", texts[0]);
    write("models/arm/model.sdf", texts[1]);
    try {
      const ImportedScene scene = read_world(folder / "worlds/d.sdf", {folder / "models"});
      for (const ImportedObject& object : scene.objects)
        EXPECT_TRUE(std::isfinite(glm::length(object.placed.position_m)));
      ++read;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::AnyOf(HasSubstr("d.sdf"), HasSubstr("model.sdf")));
    }
  }
  EXPECT_GT(read, 200);
}

TEST_F(Includes, FollowTheEnvironmentOfGazebo) {
  write_model("rock", link_at("0 5 0 0 0 0"));
  write("worlds/w.sdf",
        "<sdf version='1.9'><world name='w'>" + include_of("model://rock") + "</world></sdf>");
  for (const char* variable : {"GZ_SIM_RESOURCE_PATH", "SDF_PATH", "GAZEBO_MODEL_PATH"}) {
    Surroundings with_variable;
    with_variable.before = {"/usr/bin/env",
                            fmt::format("{}=/none:{}", variable, (folder / "models").string())};
    const Outcome made =
        run_program({"import-scene", (folder / "worlds/w.sdf").string(), "-o", (folder / variable).string()},
                    with_variable);
    EXPECT_EQ(made.exit_code, 0) << made.err;
    EXPECT_THAT(bytes_of(folder / (std::string(variable) + "/scene.toml")), HasSubstr("rock::l::v"));
  }
  EXPECT_EQ(run_program({"import-scene", (folder / "worlds/w.sdf").string(), "-o", (folder / "x").string()})
                .exit_code,
            2);
}

}  // namespace
}  // namespace tubefoot
