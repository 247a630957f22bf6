/// What a run leaves in its folder, for comparison.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace sluice::test {

/// All of a file, or "" if there is none.
std::string text_of(const std::filesystem::path& file);

/// Names of what lies in a folder, without what lies in its folders.
std::set<std::string> names_in(const std::filesystem::path& folder);

/// The names, checkpoints included, that a finished run without pictures leaves.
std::set<std::string> promised_names();

/// Size and time of last change of everything below a folder, by path.
std::map<std::string, std::string> fingerprint(const std::filesystem::path& folder);

/// What came, went or changed between two fingerprints, a line each; "" if nothing was touched.
std::string changes(const std::map<std::string, std::string>& before, const std::map<std::string, std::string>& after);

/// Shape, type and bytes of every dataset of the group VTKHDF of results.h5, by path. Throws std::runtime_error if the
/// file or a dataset cannot be read.
std::map<std::string, std::string> datasets(const std::filesystem::path& results_file);

/// The columns of a CSV file by name; a row that is cut off is left out.
std::map<std::string, std::vector<std::string>> table(const std::filesystem::path& file);

/// The last number of a column; 0 if there is none yet.
double last_number(const std::filesystem::path& file, const std::string& column);

/// Asserts that two folders hold the same states, bit for bit, and the same history and observations.
void expect_equal_results(const std::filesystem::path& found, const std::filesystem::path& expected);

}  // namespace sluice::test
