/// Pictures: starts the script that draws them, core/output/pictures.py.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/case/case.h"
#include "core/particles/particles.h"

namespace sluice {

struct PictureRequest {
  std::filesystem::path folder;     ///< holds results.h5
  std::vector<std::string> fields;  ///< empty: what the script finds useful
  std::vector<double> times;        ///< [s]; empty: four evenly spaced
  bool animation = false;
  bool quiet = false;  ///< do not print the names of the pictures
};

/// Throws CaseError at the first word of output.pictures that is no field of the results.
void require_pictured_fields(const Case& definition, const Particles& particles);

/// Runs a script that stands beside the program or in its share folder, by $SLUICE_PYTHON, else by Debian's python3,
/// and waits for its end; true if it succeeded. `quiet` leaves out what it prints. Throws std::runtime_error if there
/// is no such script.
bool run_script(const std::string& name, const std::vector<std::string>& arguments, bool quiet);

/// Draws with pictures.py, see run_script.
bool draw_pictures(const PictureRequest& request);

}  // namespace sluice
