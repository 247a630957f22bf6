#include "core/output/results_reader.h"

#include <stdexcept>

namespace sluice {

namespace {

std::string path_of(const std::string& field) { return "VTKHDF/PointData/" + field; }

}  // namespace

ResultsReader::ResultsReader(const std::filesystem::path& file) : file_(file, Hdf5File::Mode::read) {
  if (!file_.contains("VTKHDF") || !file_.contains("Sluice") || !file_.has_attribute("Sluice", "dimension"))
    throw std::runtime_error(file.string() + ": it is not a results.h5 of this program");
  dimension_ = static_cast<int>(file_.integer_attribute("Sluice", "dimension").at(0));
  materials_ = file_.read_texts("Sluice/material_names");
  times_ = file_.read<double>("VTKHDF/Steps/Values");
  for (const std::int64_t row : file_.read<std::int64_t>("VTKHDF/Steps/PointOffsets"))
    first_.push_back(static_cast<std::size_t>(row));
  for (const std::int64_t rows : file_.read<std::int64_t>("VTKHDF/NumberOfPoints"))
    count_.push_back(static_cast<std::size_t>(rows));
  if (times_.empty()) throw std::runtime_error(file.string() + ": it holds no output time");
}

std::vector<std::string> ResultsReader::fields() const { return file_.members("VTKHDF/PointData"); }

std::vector<double> ResultsReader::points(std::size_t time) const {
  return file_.read_rows<double>("VTKHDF/Points", first_.at(time), count_.at(time));
}

std::vector<double> ResultsReader::field(const std::string& name, std::size_t time) const {
  return file_.read_rows<double>(path_of(name), first_.at(time), count_.at(time));
}

std::size_t ResultsReader::components(const std::string& name) const {
  const auto shape = file_.shape(path_of(name));
  return shape.size() > 1 ? shape[1] : 1;
}

std::vector<std::int32_t> ResultsReader::numbers(const std::string& name, std::size_t time) const {
  return file_.read_rows<std::int32_t>(path_of(name), first_.at(time), count_.at(time));
}

}  // namespace sluice
