#include "core/output/xdmf.h"

#include <fmt/format.h>

#include <iterator>

namespace sluice {

namespace {

constexpr const char* real_type = "NumberType=\"Float\" Precision=\"8\"";
constexpr const char* integer_type = "NumberType=\"Int\" Precision=\"4\"";

/// Rows [first, first + rows) of a dataset with `total` rows.
struct Slab {
  std::string dataset;
  const char* type;
  std::size_t first, rows, total;
  int components;
};

void append_slab(std::string& text, const std::string& file, const Slab& slab) {
  const auto out = std::back_inserter(text);
  const bool table = slab.components > 1;
  const std::string columns = table ? fmt::format(" {}", slab.components) : "";
  fmt::format_to(out, "          <DataItem ItemType=\"HyperSlab\" Dimensions=\"{}{}\" {}>\n", slab.rows, columns,
                 slab.type);
  // Start, stride and count of every axis.
  if (table)
    fmt::format_to(out, "            <DataItem Dimensions=\"3 2\" Format=\"XML\">{} 0 1 1 {} {}</DataItem>\n",
                   slab.first, slab.rows, slab.components);
  else
    fmt::format_to(out, "            <DataItem Dimensions=\"3 1\" Format=\"XML\">{} 1 {}</DataItem>\n", slab.first,
                   slab.rows);
  fmt::format_to(out, "            <DataItem Dimensions=\"{}{}\" {} Format=\"HDF\">{}:/{}</DataItem>\n", slab.total,
                 columns, slab.type, file, slab.dataset);
  text += "          </DataItem>\n";
}

const char* attribute_type(int components) {
  if (components == 1) return "Scalar";
  if (components == 3) return "Vector";
  return "Matrix";  // components stay in their order
}

}  // namespace

std::string xdmf_text(const std::string& results_file, const std::vector<FrameHeader>& frames,
                      const std::vector<FieldSpec>& fields) {
  std::size_t total = 0, first = 0;
  for (const auto& frame : frames) total += frame.points;
  std::string text =
      "<?xml version=\"1.0\" ?>\n<!DOCTYPE Xdmf SYSTEM \"Xdmf.dtd\" []>\n<Xdmf Version=\"2.0\">\n  <Domain>\n"
      "    <Grid Name=\"particles\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  const auto out = std::back_inserter(text);
  for (const auto& frame : frames) {
    const std::size_t points = frame.points;
    fmt::format_to(out, "      <Grid Name=\"step {}\" GridType=\"Uniform\">\n        <Time Value=\"{}\"/>\n",
                   frame.step, frame.time);
    fmt::format_to(
        out, "        <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"{}\" NodesPerElement=\"1\"/>\n", points);
    text += "        <Geometry GeometryType=\"XYZ\">\n";
    append_slab(text, results_file, {"VTKHDF/Points", real_type, first, points, total, 3});
    text += "        </Geometry>\n";
    for (const auto& field : fields) {
      fmt::format_to(out, "        <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"Node\">\n", field.name,
                     attribute_type(field.components));
      append_slab(text, results_file,
                  {"VTKHDF/PointData/" + field.name, field.integer ? integer_type : real_type, first, points, total,
                   field.components});
      text += "        </Attribute>\n";
    }
    text += "      </Grid>\n";
    first += points;
  }
  return text + "    </Grid>\n  </Domain>\n</Xdmf>\n";
}

}  // namespace sluice
