#include "tests/regression/results_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace sluice::test {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

std::set<std::string> promised_names() {
  return {"case.resolved.yaml", "checkpoint_0.h5", "checkpoint_1.h5", "history.csv",
          "observations.csv",   "results.h5",      "results.xdmf",    "summary.json"};
}

std::map<std::string, std::string> fingerprint(const fs::path& folder) {
  std::map<std::string, std::string> found;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const auto changed = entry.last_write_time().time_since_epoch().count();
    const auto size = entry.is_regular_file() ? entry.file_size() : 0;
    found[entry.path().string()] = fmt::format("{} bytes, changed at {}", size, changed);
  }
  return found;
}

std::string changes(const std::map<std::string, std::string>& before, const std::map<std::string, std::string>& after) {
  std::string text;
  for (const auto& [path, what] : before)
    if (after.count(path) == 0) text += path + " went\n";
  for (const auto& [path, what] : after)
    if (const auto old = before.find(path); old == before.end())
      text += path + " came\n";
    else if (old->second != what)
      text += path + " changed\n";
  return text;
}

namespace {

std::string dataset(hid_t group, const char* path) {
  const hid_t set = H5Dopen2(group, path, H5P_DEFAULT), type = H5Dget_type(set), space = H5Dget_space(set);
  std::string text = fmt::format("class {}, {} bytes, shape", static_cast<int>(H5Tget_class(type)), H5Tget_size(type));
  std::vector<hsize_t> shape(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
  H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  for (const hsize_t n : shape) text += fmt::format(" {}", n);
  std::string bytes(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)) * H5Tget_size(type), '\0');
  const bool read = H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) >= 0;
  H5Sclose(space);
  H5Tclose(type);
  H5Dclose(set);
  if (!read) throw std::runtime_error(std::string(path) + ": cannot be read");
  return text + '\n' + bytes;
}

herr_t collect(hid_t group, const char* name, const H5O_info_t* info, void* found) {
  if (info->type == H5O_TYPE_DATASET)
    static_cast<std::map<std::string, std::string>*>(found)->emplace(name, dataset(group, name));
  return 0;
}

}  // namespace

std::map<std::string, std::string> datasets(const fs::path& results_file) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const hid_t file = H5Fopen(results_file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file < 0) throw std::runtime_error(results_file.string() + ": cannot be opened");
  const hid_t group = H5Gopen2(file, "VTKHDF", H5P_DEFAULT);
  std::map<std::string, std::string> found;
  const bool visited = H5Ovisit(group, H5_INDEX_NAME, H5_ITER_INC, collect, &found) >= 0;
  H5Gclose(group);
  H5Fclose(file);
  if (!visited || found.empty()) throw std::runtime_error(results_file.string() + ": has no states");
  return found;
}

std::map<std::string, std::vector<std::string>> table(const fs::path& file) {
  const auto cells_of = [](const std::string& line) {
    std::vector<std::string> cells;
    std::stringstream rest(line);
    for (std::string cell; std::getline(rest, cell, ',');) cells.push_back(cell);
    return cells;
  };
  std::map<std::string, std::vector<std::string>> columns;
  std::stringstream lines(text_of(file));
  std::string line;
  std::getline(lines, line);
  const auto names = cells_of(line);
  for (const auto& name : names) columns[name] = {};
  while (std::getline(lines, line)) {
    if (lines.eof()) break;
    const auto cells = cells_of(line);
    for (std::size_t i = 0; i < std::min(names.size(), cells.size()); ++i) columns[names[i]].push_back(cells[i]);
  }
  return columns;
}

double last_number(const fs::path& file, const std::string& column) {
  const auto columns = table(file);
  const auto found = columns.find(column);
  return found == columns.end() || found->second.empty() ? 0 : std::strtod(found->second.back().c_str(), nullptr);
}

void expect_equal_results(const fs::path& found, const fs::path& expected) {
  const auto a = datasets(found / "results.h5"), b = datasets(expected / "results.h5");
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [name, bytes] : b) {
    ASSERT_EQ(a.count(name), 1u) << name;
    EXPECT_TRUE(a.at(name) == bytes) << name << " differs: found " << a.at(name).substr(0, a.at(name).find('\n'))
                                     << ", expected " << bytes.substr(0, bytes.find('\n'));
  }
  for (const auto* name : {"history.csv", "observations.csv"})
    EXPECT_TRUE(text_of(found / name) == text_of(expected / name)) << name << " differs";
}

}  // namespace sluice::test
