#include "core/output/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "core/output/file_aside.h"
#include "core/output/hdf5_file.h"
#include "core/output/xdmf.h"

namespace sluice {

namespace {

using Mode = Hdf5File::Mode;

enum class Element { real, integer32, integer64, byte };

/// A dataset that grows by some rows with every frame.
struct TemporalDataset {
  std::string path;
  Element element;
  std::size_t components;
  std::size_t extra_rows;  // rows per frame beyond the number of points

  std::size_t rows(const FrameHeader& frame) const { return frame.points + extra_rows; }
  Hdf5File::Shape shape(std::size_t rows_in_all) const {
    return components == 1 ? Hdf5File::Shape{rows_in_all} : Hdf5File::Shape{rows_in_all, components};
  }
};

std::vector<TemporalDataset> temporal_datasets(const std::vector<FieldSpec>& fields) {
  std::vector<TemporalDataset> datasets{{"VTKHDF/Points", Element::real, 3, 0},
                                        {"VTKHDF/Connectivity", Element::integer64, 1, 0},
                                        {"VTKHDF/Offsets", Element::integer64, 1, 1},
                                        {"VTKHDF/Types", Element::byte, 1, 0}};
  for (const auto& field : fields)
    datasets.push_back({"VTKHDF/PointData/" + field.name, field.integer ? Element::integer32 : Element::real,
                        static_cast<std::size_t>(field.components), 0});
  return datasets;
}

/// Calls `action` with a value of the element type.
template <class Action>
void with_element(Element element, Action action) {
  switch (element) {
    case Element::real:
      return action(double{});
    case Element::integer32:
      return action(std::int32_t{});
    case Element::integer64:
      return action(std::int64_t{});
    case Element::byte:
      return action(std::uint8_t{});
  }
}

std::size_t total_rows(const TemporalDataset& dataset, const std::vector<FrameHeader>& frames) {
  std::size_t rows = 0;
  for (const auto& frame : frames) rows += dataset.rows(frame);
  return rows;
}

void present_frames(Hdf5File& file, const TemporalDataset& dataset, const std::vector<FrameHeader>& frames,
                    const std::vector<std::string>& frame_files) {
  std::vector<VirtualPart> parts;
  std::size_t first_row = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    parts.push_back({frame_files[i], "/" + dataset.path, first_row, dataset.rows(frames[i])});
    first_row += dataset.rows(frames[i]);
  }
  with_element(dataset.element, [&](auto element) {
    file.create_virtual<decltype(element)>(dataset.path, dataset.shape(first_row), parts);
  });
}

void copy_rows(const Hdf5File& from, std::size_t from_row, Hdf5File& to, std::size_t to_row, std::size_t rows,
               const TemporalDataset& dataset) {
  with_element(dataset.element, [&](auto element) {
    using T = decltype(element);
    to.write_rows<T>(dataset.path, to_row, from.read_rows<T>(dataset.path, from_row, rows));
  });
}

void create_contiguous(Hdf5File& file, const TemporalDataset& dataset, std::size_t rows) {
  with_element(dataset.element,
               [&](auto element) { file.create<decltype(element)>(dataset.path, dataset.shape(rows)); });
}

void copy_frames(Hdf5File& file, const std::vector<TemporalDataset>& datasets, const std::vector<FrameHeader>& frames,
                 const std::vector<std::filesystem::path>& frame_files) {
  for (const auto& dataset : datasets) create_contiguous(file, dataset, total_rows(dataset, frames));
  std::vector<std::size_t> row(datasets.size(), 0);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Hdf5File frame(frame_files[i], Mode::read);
    for (std::size_t d = 0; d < datasets.size(); ++d) {
      copy_rows(frame, 0, file, row[d], datasets[d].rows(frames[i]), datasets[d]);
      row[d] += datasets[d].rows(frames[i]);
    }
  }
}

void describe_fields(Hdf5File& file, const std::vector<FieldSpec>& fields) {
  for (const auto& field : fields) {
    file.set_attribute("VTKHDF/PointData/" + field.name, "unit", field.unit);
    file.set_attribute("VTKHDF/PointData/" + field.name, "description", field.sentence);
  }
}

/// The index of the VTKHDF layout, version 2: what belongs to which time. Every time is one part.
void write_steps(Hdf5File& file, const std::vector<FrameHeader>& frames, const std::vector<FieldSpec>& fields) {
  std::vector<std::int64_t> points, first_point, part;
  std::vector<double> times;
  std::int64_t sum = 0;
  for (const auto& frame : frames) {
    part.push_back(static_cast<std::int64_t>(times.size()));
    times.push_back(frame.time);
    first_point.push_back(sum);
    points.push_back(static_cast<std::int64_t>(frame.points));
    sum += points.back();
  }
  for (const auto* name : {"NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"})
    file.write(std::string("VTKHDF/") + name, points);
  file.create_group("VTKHDF/Steps");
  file.set_attribute("VTKHDF/Steps", "NSteps", static_cast<std::int64_t>(frames.size()));
  file.write("VTKHDF/Steps/Values", times);
  file.write("VTKHDF/Steps/PartOffsets", part);
  file.write("VTKHDF/Steps/NumberOfParts", std::vector<std::int64_t>(frames.size(), 1));
  file.write("VTKHDF/Steps/PointOffsets", first_point);
  // One column: an unstructured grid has one kind of topology.
  file.write("VTKHDF/Steps/CellOffsets", first_point, {frames.size(), 1});
  file.write("VTKHDF/Steps/ConnectivityIdOffsets", first_point, {frames.size(), 1});
  for (const auto& field : fields) file.write("VTKHDF/Steps/PointDataOffsets/" + field.name, first_point);
}

void write_provenance(Hdf5File& file, const Provenance& provenance) {
  file.create_group("Sluice");
  file.write_text("Sluice/case", provenance.case_text);
  file.write_text("Sluice/resolved_case", provenance.resolved_case);
  file.set_attribute("Sluice", "title", provenance.title);
  file.set_attribute("Sluice", "version", provenance.version);
  file.set_attribute("Sluice", "compiler", provenance.compiler);
  file.set_attribute("Sluice", "host", provenance.host);
  file.set_attribute("Sluice", "start_time", provenance.start_time);
  file.set_attribute("Sluice", "threads", static_cast<std::int64_t>(provenance.threads));
  file.set_attribute("Sluice", "dimension", static_cast<std::int64_t>(provenance.grid.min.size()));
  file.set_attribute("Sluice", "grid_min", provenance.grid.min);
  file.set_attribute("Sluice", "grid_max", provenance.grid.max);
  file.set_attribute("Sluice", "grid_cell", provenance.grid.cell);
}

void write_columns(Hdf5File& file, const std::vector<ColumnSpec>& columns) {
  for (const auto& spec : columns) {
    const std::string group = "Sluice/columns/" + spec.name;
    file.create_group(group);
    file.set_attribute(group, "unit", spec.unit);
    file.set_attribute(group, "components", static_cast<std::int64_t>(spec.components));
    file.set_attribute(group, "role", std::string(spec.role == Role::state ? "state" : "derived"));
    file.set_attribute(group, "description", spec.sentence);
  }
}

std::string frame_name(std::size_t index) { return fmt::format("frame_{:06}.h5", index); }

/// Reads the index of a finished results.h5.
std::vector<FrameHeader> finished_frames(const Hdf5File& file) {
  const auto times = file.read<double>("VTKHDF/Steps/Values");
  const auto points = file.read<std::int64_t>("VTKHDF/NumberOfPoints");
  const auto steps = file.read<std::int64_t>("Sluice/steps");
  std::vector<FrameHeader> frames;
  for (std::size_t i = 0; i < times.size(); ++i)
    frames.push_back({times[i], steps.at(i), static_cast<std::size_t>(points.at(i))});
  return frames;
}

}  // namespace

ResultsWriter::ResultsWriter(std::filesystem::path folder, Provenance provenance, const Particles& particles)
    : folder_(std::move(folder)),
      provenance_(std::move(provenance)),
      fields_(result_fields(particles)),
      columns_(particles.columns.specs()),
      material_names_(particles.material_names) {
  for (const auto& old : {results_path(), folder_ / "results.xdmf", frames_path()}) std::filesystem::remove_all(old);
  std::filesystem::create_directory(frames_path());
}

ResultsWriter::ResultsWriter(std::filesystem::path folder, Provenance provenance, const Particles& particles,
                             double resume_time)
    : folder_(std::move(folder)),
      provenance_(std::move(provenance)),
      fields_(result_fields(particles)),
      columns_(particles.columns.specs()),
      material_names_(particles.material_names) {
  split_finished_results();
  std::filesystem::create_directory(frames_path());
  collect_frames(resume_time);
}

std::filesystem::path ResultsWriter::frame_path(std::size_t index) const { return frames_path() / frame_name(index); }

/// Turns a finished results.h5 back into frame files. It stays as it is until `collect_frames` replaces it, so that a
/// kill in between leaves it whole; frame files beside a finished results.h5 are remains of such a kill.
void ResultsWriter::split_finished_results() {
  if (!std::filesystem::exists(results_path())) return;
  const Hdf5File results(results_path(), Mode::read);
  if (results.text_attribute("Sluice", "layout") != "contiguous") return;
  std::filesystem::remove_all(frames_path());
  std::filesystem::create_directory(frames_path());
  const auto fields = read_frame_fields(results_path());
  const auto datasets = temporal_datasets(fields);
  std::vector<std::size_t> row(datasets.size(), 0);
  const auto frames = finished_frames(results);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    FileAside aside(frame_path(i));
    Hdf5File file(aside.path(), Mode::create);
    file.create_group("VTKHDF/PointData");
    file.set_attribute("/", "time", frames[i].time);
    file.set_attribute("/", "step", frames[i].step);
    for (std::size_t d = 0; d < datasets.size(); ++d) {
      const std::size_t rows = datasets[d].rows(frames[i]);
      create_contiguous(file, datasets[d], rows);
      copy_rows(results, row[d], file, 0, rows, datasets[d]);
      row[d] += rows;
    }
    describe_fields(file, fields);
    file.close();
    aside.commit();
  }
}

void ResultsWriter::collect_frames(double resume_time) {
  std::size_t count = 0;
  while (std::filesystem::exists(frame_path(count))) ++count;
  while (frames_.size() < count) {
    const auto path = frame_path(frames_.size());
    const FrameHeader frame = read_frame_header(path);
    if (frame.time > resume_time) break;
    if (read_frame_fields(path) != fields_)
      throw std::runtime_error(path.string() + ": cannot be continued: it has other fields than this run writes");
    frames_.push_back(frame);
  }
  // First results.h5 stops to present the frames that are dropped, then they go.
  if (frames_.empty())
    for (const auto* name : {"results.h5", "results.xdmf"}) std::filesystem::remove(folder_ / name);
  else
    write_results(Layout::virtual_frames);
  for (std::size_t i = count; i-- > frames_.size();) std::filesystem::remove(frame_path(i));
}

void ResultsWriter::add_frame(const Particles& particles, double time, std::int64_t step) {
  if (!frames_.empty() && time == frames_.back().time) return;
  if (!frames_.empty() && time < frames_.back().time)
    throw std::invalid_argument(fmt::format("a frame at {} s cannot follow one at {} s", time, frames_.back().time));
  frames_.push_back(write_frame(frame_path(frames_.size()), particles, time, step));
  write_results(Layout::virtual_frames);
}

void ResultsWriter::finish() {
  if (!frames_.empty()) write_results(Layout::contiguous);
  std::filesystem::remove_all(frames_path());
}

void ResultsWriter::write_results(Layout layout) const {
  FileAside aside(results_path());
  Hdf5File file(aside.path(), Mode::create);
  file.create_group("VTKHDF/PointData");
  file.set_attribute("VTKHDF", "Version", std::vector<std::int64_t>{2, 0});
  file.set_attribute("VTKHDF", "Type", std::string("UnstructuredGrid"));
  write_steps(file, frames_, fields_);
  write_provenance(file, provenance_);
  write_columns(file, columns_);
  file.write_texts("Sluice/material_names", material_names_);
  file.set_attribute("Sluice", "layout", std::string(layout == Layout::contiguous ? "contiguous" : "virtual"));
  std::vector<std::int64_t> steps;
  std::vector<std::string> sources;
  std::vector<std::filesystem::path> paths;
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    steps.push_back(frames_[i].step);
    sources.push_back("frames/" + frame_name(i));
    paths.push_back(frame_path(i));
  }
  file.write("Sluice/steps", steps);
  const auto datasets = temporal_datasets(fields_);
  if (layout == Layout::contiguous)
    copy_frames(file, datasets, frames_, paths);
  else
    for (const auto& dataset : datasets) present_frames(file, dataset, frames_, sources);
  describe_fields(file, fields_);
  file.close();
  aside.commit();
  replace_text_file(folder_ / "results.xdmf", xdmf_text("results.h5", frames_, fields_));
}

}  // namespace sluice
