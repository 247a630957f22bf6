/// XDMF: the small XML file by which ParaView 5.11 and other readers find the frames in results.h5.
#pragma once

#include <string>
#include <vector>

#include "core/output/frame.h"

namespace sluice {

/// A temporal collection of vertex grids that refers to slabs of the datasets of `results_file` (named relative to the
/// XDMF file).
std::string xdmf_text(const std::string& results_file, const std::vector<FrameHeader>& frames,
                      const std::vector<FieldSpec>& fields);

}  // namespace sluice
