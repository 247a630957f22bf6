#include "core/case/region_schema.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace sluice {

namespace {

const Components dimensions{{2, 3}};

Schema<Box> box_schema() {
  return Schema<Box>("box")
      .quantities("min", &Box::min, unit::length, any_number, dimensions, "Lower corner, which belongs to the box.")
      .quantities("max", &Box::max, unit::length, any_number, dimensions, "Upper corner, which does not.");
}

Schema<HalfSpace> half_space_schema() {
  return Schema<HalfSpace>("half_space")
      .quantities("point", &HalfSpace::point, unit::length, any_number, dimensions, "A point on the surface.")
      .quantities("normal", &HalfSpace::normal, unit::none, any_number, dimensions,
                  "Points out of the half-space; of any length but 0.");
}

Schema<Sphere> sphere_schema() {
  return Schema<Sphere>("sphere")
      .quantities("centre", &Sphere::centre, unit::length, any_number, dimensions, "Its centre.")
      .quantity("radius", &Sphere::radius, unit::length, above(0), "Its radius.");
}

void read_sphere(Region& region, const Node& node, Problems& problems) {
  static const Schema<Sphere> schema = sphere_schema();
  Sphere sphere = schema.read(node, {}, problems);
  if (!sphere.centre.empty() && sphere.radius > 0) region.parts.emplace_back(std::move(sphere));
}

Schema<Circle> circle_schema() {
  return Schema<Circle>("circle")
      .quantities("centre", &Circle::centre, unit::length, any_number, {{2}}, "Its centre.")
      .quantity("radius", &Circle::radius, unit::length, above(0), "Its radius.");
}

void read_circle(Region& region, const Node& node, Problems& problems) {
  static const Schema<Circle> schema = circle_schema();
  Circle circle = schema.read(node, {}, problems);
  if (!circle.centre.empty() && circle.radius > 0) region.parts.emplace_back(std::move(circle));
}

Schema<Layer> layer_schema() {
  return Schema<Layer>("layer")
      .quantity("bottom", &Layer::bottom, unit::length, any_number, "Lower level, which belongs to the layer.",
                Absent{"everything below top"})
      .quantity("top", &Layer::top, unit::length, any_number, "Upper level, which does not.",
                Absent{"everything above bottom"});
}

void read_layer(Region& region, const Node& node, Problems& problems) {
  static const Schema<Layer> schema = layer_schema();
  const Layer layer = schema.read(node, {}, problems);
  if (!layer.bottom && !layer.top) {
    if (!node.find("bottom") && !node.find("top"))
      problems.add(node.place, "layer: it has neither bottom nor top; give one or both");
    return;
  }
  if (layer.bottom && layer.top && *layer.bottom >= *layer.top) {
    problems.add(node.place,
                 fmt::format("layer: top is {:g} m; it must be above bottom, {:g} m", *layer.top, *layer.bottom));
    return;
  }
  region.parts.emplace_back(layer);
}

// ---- rasters ----

/// `node` holds the file, with its folder (case_tree).
template <bool Below>
void read_raster_side(Region& region, const Node& node, Problems& problems) {
  const auto file = value::text(node, Below ? "below_raster" : "above_raster", problems);
  if (!file) return;
  try {
    region.parts.emplace_back(RasterSide{std::make_shared<const Raster>(read_raster(*file)), Below});
  } catch (const CaseError& error) {
    problems.add(node.place, error);
  }
}

template <bool Below>
Node write_raster_side(const Region& region) {
  for (const Primitive& part : region.parts)
    if (const auto* const side = std::get_if<RasterSide>(&part); side != nullptr && side->below == Below)
      return Node::text(side->raster->file());
  return {};
}

// ---- combinations ----

template <class Combination>
void read_combination(Region& region, const Node& node, Problems& problems) {
  constexpr bool difference = std::is_same_v<Combination, Difference>;
  constexpr const char* name = difference                           ? "difference"
                               : std::is_same_v<Combination, Union> ? "union"
                                                                    : "intersection";
  constexpr std::size_t least = difference ? 2 : 1;
  if (node.kind != Node::Kind::list || node.items.size() < least) {
    const std::string found =
        node.kind != Node::Kind::list ? description(node) : fmt::format("a list of {}", node.items.size());
    problems.add(node.place, fmt::format("{}: found {}; expected a list of {}, each beginning with a dash", name, found,
                                         difference ? "two regions or more, the first less the others" : "regions"));
    return;
  }
  Combination combination;
  for (const Node& item : node.items) {
    combination.of.push_back(region_schema().read(item, {}, problems));
    require_shape(item, fmt::format("region in the {}", name), problems);
  }
  for (const Region& part : combination.of)
    if (part.parts.empty()) return;  // reported
  region.parts.emplace_back(std::move(combination));
}

void read_box(Region& region, const Node& node, Problems& problems) {
  static const Schema<Box> schema = box_schema();
  Box box = schema.read(node, {}, problems);
  if (box.min.empty() || box.max.empty()) return;  // reported
  if (box.min.size() != box.max.size()) {
    problems.add(node.place, fmt::format("box: min has {} components, max has {}", box.min.size(), box.max.size()));
    return;
  }
  bool filled = true;
  for (std::size_t a = 0; a < box.min.size(); ++a) {
    if (box.min[a] < box.max[a]) continue;
    filled = false;
    problems.add(node.place, fmt::format("box: component {} of max is {:g} m; it must be above that of min, {:g} m",
                                         a + 1, box.max[a], box.min[a]));
  }
  if (filled) region.parts.emplace_back(std::move(box));
}

void read_polygon(Region& region, const Node& node, Problems& problems) {
  if (node.kind != Node::Kind::list || node.items.size() < 3) {
    problems.add(node.place,
                 fmt::format("polygon: found {}; expected three or more points [[x, y], …], or FILE.yaml#NAME",
                             description(node)));
    return;
  }
  Polygon polygon;
  for (const Node& item : node.items)
    if (const auto x = value::quantities(item, "point of the polygon", unit::length, any_number, {{2}}, problems))
      polygon.vertices.push_back({(*x)[0], (*x)[1]});
  if (polygon.vertices.size() != node.items.size()) return;  // reported
  if (polygon.area() <= 0) {
    problems.add(node.place, "polygon: its area is 0");
    return;
  }
  region.parts.emplace_back(std::move(polygon));
}

void read_half_space(Region& region, const Node& node, Problems& problems) {
  static const Schema<HalfSpace> schema = half_space_schema();
  if (node.kind == Node::Kind::list) {
    for (const Node& item : node.items) read_half_space(region, item, problems);
    return;
  }
  HalfSpace half_space = schema.read(node, {}, problems);
  if (half_space.point.empty() || half_space.normal.empty()) return;  // reported
  double length = 0;
  for (const double n : half_space.normal) length += n * n;
  if (length <= 0 || half_space.point.size() != half_space.normal.size()) {
    problems.add(node.place, length <= 0 ? "half_space: its normal is 0"
                                         : "half_space: point and normal have different "
                                           "numbers of components");
    return;
  }
  region.parts.emplace_back(std::move(half_space));
}

template <class Shape>
std::vector<Shape> shapes_of(const Region& region) {
  std::vector<Shape> shapes;
  for (const Primitive& part : region.parts)
    if (const auto* const shape = std::get_if<Shape>(&part)) shapes.push_back(*shape);
  return shapes;
}

Node write_box(const Region& region) {
  const auto boxes = shapes_of<Box>(region);
  return boxes.empty() ? Node{} : box_schema().write(boxes.front());
}

Node write_polygon(const Region& region) {
  Node points = Node::list();
  for (const Polygon& polygon : shapes_of<Polygon>(region))
    for (const auto& [x, z] : polygon.vertices) points.items.push_back(value::from_quantities({x, z}, unit::length));
  return points.items.empty() ? Node{} : points;
}

Node write_half_spaces(const Region& region) {
  Node all = Node::list();
  for (const HalfSpace& half_space : shapes_of<HalfSpace>(region))
    all.items.push_back(half_space_schema().write(half_space));
  if (all.items.size() == 1) return all.items.front();
  return all.items.empty() ? Node{} : all;
}

Node write_sphere(const Region& region) {
  const auto spheres = shapes_of<Sphere>(region);
  return spheres.empty() ? Node{} : sphere_schema().write(spheres.front());
}

Node write_circle(const Region& region) {
  const auto circles = shapes_of<Circle>(region);
  return circles.empty() ? Node{} : circle_schema().write(circles.front());
}

Node write_layer(const Region& region) {
  const auto layers = shapes_of<Layer>(region);
  return layers.empty() ? Node{} : layer_schema().write(layers.front());
}

template <class Combination>
Node write_combination(const Region& region) {
  const auto found = shapes_of<Combination>(region);
  if (found.empty()) return {};
  Node list = Node::list();
  for (const Region& part : found.front().of) list.items.push_back(region_schema().write(part));
  return list;
}

FieldDoc section_doc(const std::string& name, const std::string& sentence, const std::vector<FieldDoc>& keys) {
  return {.name = name, .type = field_type::section, .default_text = "none", .sentence = sentence, .nested = keys};
}

FieldDoc raster_doc(const std::string& name, const std::string& sentence) {
  return {.name = name,
          .type = field_type::text,
          .range = "an ESRI ASCII file; 3-D only",
          .default_text = "none",
          .sentence = sentence};
}

/// Regions in regions: their keys are these very ones.
FieldDoc combination_doc(const std::string& name, const std::string& sentence) {
  return {.name = name,
          .type = field_type::sections,
          .range = "regions: each one of these shapes, or the intersection of several",
          .default_text = "none",
          .sentence = sentence};
}

std::vector<ShapeKey> make_shape_keys() {
  FieldDoc half_spaces =
      section_doc("half_space", "Everything on one side of a plane; several in a list are intersected.",
                  half_space_schema().docs());
  half_spaces.alternatives = {{.type = field_type::sections, .nested = half_space_schema().docs()}};
  return {
      {section_doc("box", "Axis-aligned box.", box_schema().docs()), read_box, write_box},
      {{.name = "polygon",
        .type = field_type::points,
        .unit = "m",
        .range = "three points [x, y] or more; [x, z] in 3-D",
        .default_text = "none",
        .sentence = "Closed polygon in the plane of the first and last axis, in 3-D a prism along the middle axis; or "
                    "`FILE.yaml#NAME`, a polygon in a file beside this one.",
        .alternatives = {{.type = field_type::text}}},
       read_polygon,
       write_polygon},
      {std::move(half_spaces), read_half_space, write_half_spaces},
      {section_doc("circle",
                   "Disc in the plane of the first two axes; in 3-D an upright cylinder, which `layer` beside it cuts.",
                   circle_schema().docs()),
       read_circle, write_circle},
      {section_doc("sphere", "Ball; in 2-D a disc.", sphere_schema().docs()), read_sphere, write_sphere},
      {section_doc("layer", "Everything between two levels along the last axis.", layer_schema().docs()), read_layer,
       write_layer},
      {raster_doc("below_raster", "What lies below the surface whose heights the file holds, bilinear between them."),
       read_raster_side<true>, write_raster_side<true>},
      {raster_doc("above_raster", "What lies on and above such a surface: the rest."), read_raster_side<false>,
       write_raster_side<false>},
      {combination_doc("union", "What lies in any of these regions."), read_combination<Union>,
       write_combination<Union>},
      {combination_doc("intersection", "What lies in all of these regions."), read_combination<Intersection>,
       write_combination<Intersection>},
      {combination_doc("difference", "What lies in the first of these regions and in none of the others."),
       read_combination<Difference>, write_combination<Difference>}};
}

}  // namespace

const std::vector<ShapeKey>& shape_keys() {
  static const std::vector<ShapeKey> keys = make_shape_keys();
  return keys;
}

void require_shape(const Node& section, const std::string& what, Problems& problems) {
  std::vector<std::string> names;
  for (const ShapeKey& key : shape_keys()) names.push_back(key.doc.name);
  if (section.kind != Node::Kind::map ||
      std::ranges::any_of(names, [&](const std::string& name) { return section.find(name) != nullptr; }))
    return;
  problems.add(section.place, fmt::format("{}: it has no shape; give one or more of {}", what, fmt::join(names, ", ")));
}

const Schema<Region>& region_schema() {
  static const Schema<Region> schema = [] {
    Schema<Region> declared("region");
    return with_shapes(
        declared, [](Region& region) -> Region& { return region; },
        [](const Region& region) -> const Region& { return region; });
  }();
  return schema;
}

}  // namespace sluice
