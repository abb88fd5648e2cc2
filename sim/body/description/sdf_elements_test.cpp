// The list of SDF elements against libsdformat's own specification and against the documentation.
// SPDX-License-Identifier: Apache-2.0
#include "sim/body/description/sdf_elements.h"

#include <memory>
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <sdf/sdf.hh>

#include "sim/body/description/files_testing.h"
#include "sim/body/description/world_model.h"

namespace kaz::sim {
namespace {

void expect_attributes(const sdf::ElementPtr& element, const SdfElement& known) {
  for (unsigned i = 0; i < element->GetAttributeCount(); ++i) {
    const std::string name = element->GetAttribute(i)->GetKey();
    EXPECT_TRUE(has_word(known.attributes, name) || has_word(known.noted, name))
        << name << " of <" << element->GetName() << "> has no class";
  }
}

// Elements that are noted or refused are so with all that they contain.
void expect_classes(const sdf::ElementPtr& element, const std::string& context,
                    std::set<std::string>& seen) {
  for (unsigned i = 0; i < element->GetElementDescriptionCount(); ++i) {
    const sdf::ElementPtr child = element->GetElementDescription(i);
    const std::string name = child->GetName();
    const SdfElement* known = sdf_element(context, name);
    ASSERT_NE(known, nullptr) << "<" << name << "> in <" << context << "> has no class";
    if (known->use != Use::used) continue;
    expect_attributes(child, *known);
    if (seen.insert(context + ">" + name).second)
      expect_classes(child, sdf_context(context, name), seen);
  }
}

TEST(SdfElements, ClassifyTheSpecificationOfTheLibrary) {
  const auto specification = std::make_shared<sdf::SDF>();
  ASSERT_TRUE(sdf::init(specification));
  expect_attributes(specification->Root(), *sdf_element("", "sdf"));
  std::set<std::string> seen;
  expect_classes(specification->Root(), "sdf", seen);
  EXPECT_GT(seen.size(), 80u);
}

// Text with the element `part` in `parent`, which is in a movable model or in the world.
std::string world_with(std::string_view parent, const std::string& part) {
  const auto in = [&](std::string_view name) { return parent == name ? part : std::string(); };
  const std::string shape =
      "<geometry><sphere><radius>1</radius></sphere>" + in("geometry") + "</geometry>";
  const std::string axis = "<axis><xyz>0 0 1</xyz><dynamics>" + in("dynamics") +
                           "</dynamics><limit>" + in("limit") + "</limit>" + in("axis") + "</axis>";
  const std::string surface =
      "<surface><friction><ode>" + in("friction/ode") + "</ode><torsional>" + in("torsional") +
      "</torsional>" + in("friction") + "</friction><contact><ode>" + in("contact/ode") + "</ode>" +
      in("contact") + "</contact>" + in("surface") + "</surface>";
  return test::world_text(
      "0 0 -9.8",
      in("world") + "<wind>" + in("wind") +
          "</wind><model name='m'><link name='a'><velocity_decay>" + in("velocity_decay") +
          "</velocity_decay><inertial><mass>1</mass><inertia><ixx>1</ixx></inertia>" +
          in("inertial") + "</inertial><collision name='c'>" + shape + surface + in("collision") +
          "</collision><visual name='v'><geometry><mesh><uri>part.stl</uri>" + in("mesh") +
          "</mesh></geometry><material>" + in("material") + "</material>" + in("visual") +
          "</visual>" + in("link") +
          "</link><joint name='j' type='revolute'><parent>world</parent>"
          "<child>a</child>" +
          axis + in("joint") + "</joint>" + in("model") + "</model>");
}

// Parents whose elements are tested elsewhere: an included model, and shapes, of which only one may occur.
bool is_tested_here(const SdfElement& element) {
  static const std::set<std::string_view> kOthers{"sdf", "include", "geometry", "mesh"};
  return element.use != Use::used && !kOthers.contains(element.parent) && element.name != "light";
}

TEST(SdfElements, AreTreatedAsTheListSays) {
  const test::Folder folder;
  folder.write("part.stl",
               "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
               "vertex 0 1 0\nendloop\nendfacet\nendsolid a\n");
  const auto load = [&](const SdfElement& element, const std::string& value) {
    const std::string name(element.name);
    return load_world(folder.write(
        "w.sdf", world_with(element.parent, "<" + name + ">" + value + "</" + name + ">")));
  };
  for (const SdfElement& element : kSdfElements) {
    if (!is_tested_here(element)) continue;
    const std::string tag = "<" + std::string(element.name) + ">";
    const auto world = load(element, "");
    EXPECT_EQ(world.has_value(), element.use == Use::noted)
        << tag << " in " << element.parent << (world ? "" : full_text(world.error()));
    if (world)
      EXPECT_EQ(summary(world->notes), tag);
    else
      EXPECT_NE(full_text(world.error()).find(tag), std::string::npos) << full_text(world.error());
    EXPECT_EQ(element.use == Use::refused, !element.remedy.empty()) << tag;
    if (element.harmless.empty()) continue;
    const auto harmless = load(element, std::string(element.harmless));
    ASSERT_TRUE(harmless) << tag << full_text(harmless.error());
    EXPECT_EQ(summary(harmless->notes), "") << tag;
  }
}

TEST(SdfElements, RefusedAreListedOnThePageOfWorlds) {
  const std::string page = test::read_text("docs/reference/worlds.md");
  for (const SdfElement& element : kSdfElements) {
    if (element.use != Use::refused) continue;
    EXPECT_NE(page.find("`" + std::string(element.name) + "`"), std::string::npos)
        << element.name << " in " << element.parent;
  }
}

}  // namespace
}  // namespace kaz::sim
