#include "core/output/frame.h"

#include <algorithm>
#include <numeric>
#include <span>

#include "core/output/file_aside.h"
#include "core/output/hdf5_file.h"

namespace sluice {

namespace {

constexpr std::uint8_t vtk_vertex = 1;
constexpr int point_dimension = 3;  // ParaView wants three coordinates, and three components of a vector

int stored_components(const ColumnSpec& spec, int dimension) {
  return spec.components == dimension ? point_dimension : spec.components;
}

/// Components of one column side by side; those beyond the ones of the column are zero.
std::vector<double> interleaved(const Columns& columns, ColumnId id, int components) {
  const std::size_t stride = static_cast<std::size_t>(components);
  std::vector<double> values(columns.size() * stride);
  const int present = std::min(components, columns.specs()[static_cast<std::size_t>(id.index)].components);
  for (int k = 0; k < present; ++k) {
    const double* from = columns.data(id, k);
    for (std::size_t i = 0; i < columns.size(); ++i) values[i * stride + static_cast<std::size_t>(k)] = from[i];
  }
  return values;
}

std::vector<double> displacements(const Particles& particles) {
  std::vector<double> values(particles.size() * point_dimension, 0.0);
  for (std::size_t i = 0; i < particles.size(); ++i)
    for (int k = 0; k < particles.dimension; ++k)
      values[i * point_dimension + static_cast<std::size_t>(k)] = particles.displacement(i, k);
  return values;
}

std::string path_of(const FieldSpec& field) { return "VTKHDF/PointData/" + field.name; }

template <class T>
void write_field(Hdf5File& file, const FieldSpec& field, const std::vector<T>& values) {
  const auto components = static_cast<std::size_t>(field.components);
  Hdf5File::Shape shape{values.size() / components};
  if (components > 1) shape.push_back(components);
  file.write(path_of(field), values, shape);
  file.set_attribute(path_of(field), "unit", field.unit);
  file.set_attribute(path_of(field), "description", field.sentence);
}

void write_cells(Hdf5File& file, std::size_t points) {
  std::vector<std::int64_t> count(points + 1);
  std::iota(count.begin(), count.end(), 0);
  file.write("VTKHDF/Offsets", count);
  count.pop_back();
  file.write("VTKHDF/Connectivity", count);
  file.write("VTKHDF/Types", std::vector<std::uint8_t>(points, vtk_vertex));
}

}  // namespace

std::vector<FieldSpec> result_fields(const Particles& particles) {
  std::vector<FieldSpec> fields;
  const auto& specs = particles.columns.specs();
  for (std::size_t c = 0; c < specs.size(); ++c) {
    const ColumnSpec& spec = specs[c];
    if (spec.role != Role::state || !spec.output || static_cast<int>(c) == particles.position.index) continue;
    fields.push_back({spec.name, spec.unit, spec.sentence, stored_components(spec, particles.dimension), false});
  }
  fields.push_back({"displacement", "m", "Position minus initial position, along periodic axes with every turn.",
                    point_dimension, false});
  fields.push_back({"material", "1", "Index into /Sluice/material_names.", 1, true});
  fields.push_back({"id", "1", "Identity of the particle, the same at all times.", 1, true});
  std::sort(fields.begin(), fields.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return fields;
}

FrameHeader write_frame(const std::filesystem::path& path, const Particles& particles, double time, std::int64_t step) {
  FileAside aside(path);
  Hdf5File file(aside.path(), Hdf5File::Mode::create);
  const std::size_t points = particles.size();
  file.create_group("VTKHDF/PointData");
  file.set_attribute("/", "time", time);
  file.set_attribute("/", "step", step);
  file.write("VTKHDF/Points", interleaved(particles.columns, particles.position, point_dimension),
             {points, std::size_t{point_dimension}});
  write_cells(file, points);
  for (const auto& field : result_fields(particles)) {
    if (field.name == "id")
      write_field(file, field, particles.id);
    else if (field.name == "material")
      write_field(file, field, particles.material);
    else if (field.name == "displacement")
      write_field(file, field, displacements(particles));
    else
      write_field(file, field, interleaved(particles.columns, particles.columns.find(field.name), field.components));
  }
  file.close();
  aside.commit();
  return {time, step, points};
}

FrameHeader read_frame_header(const std::filesystem::path& path) {
  const Hdf5File file(path, Hdf5File::Mode::read);
  return {file.real_attribute("/", "time").at(0), file.integer_attribute("/", "step").at(0),
          file.shape("VTKHDF/Points").at(0)};
}

std::vector<FieldSpec> read_frame_fields(const std::filesystem::path& path) {
  const Hdf5File file(path, Hdf5File::Mode::read);
  std::vector<FieldSpec> fields;
  for (const auto& name : file.members("VTKHDF/PointData")) {
    FieldSpec field{name, "", "", 1, false};
    const auto shape = file.shape(path_of(field));
    if (shape.size() > 1) field.components = static_cast<int>(shape[1]);
    field.integer = !file.is_floating_point(path_of(field));
    field.unit = file.text_attribute(path_of(field), "unit");
    field.sentence = file.text_attribute(path_of(field), "description");
    fields.push_back(std::move(field));
  }
  return fields;
}

}  // namespace sluice
