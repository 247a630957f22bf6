/// ResultsWriter: DIR/results.h5 and DIR/results.xdmf.
///
/// results.h5 is a temporal VTKHDF file (unstructured grid of vertex cells) with units and descriptions as attributes
/// and the provenance under /Sluice. A run that is killed at any moment leaves a results.h5 that opens and holds all
/// frames that were complete:
/// - every frame is a file of its own, DIR/frames/frame_NNNNNN.h5, and results.h5 is a small file that presents them as
///   virtual datasets; each file is written aside and moved into place;
/// - `finish` replaces results.h5 by one that holds the data itself, and then removes DIR/frames.
/// Power failure is not guarded against: that is the task of checkpoints.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/output/frame.h"
#include "core/output/provenance.h"
#include "core/particles/particles.h"

namespace sluice {

class ResultsWriter {
 public:
  /// Begins new results in an existing folder, in place of older ones. `particles` have all columns declared and their
  /// materials named.
  ResultsWriter(std::filesystem::path folder, Provenance provenance, const Particles& particles);
  /// Continues older results, finished or not: keeps the frames with time <= `resume_time` [s] and drops the others.
  ResultsWriter(std::filesystem::path folder, Provenance provenance, const Particles& particles, double resume_time);

  /// Adds the state at `time` [s]. Nothing happens if the last frame has this very time, as after a resume; an earlier
  /// time is a std::invalid_argument.
  void add_frame(const Particles& particles, double time, std::int64_t step);
  /// Moves all data into results.h5 and removes DIR/frames.
  void finish();

  std::size_t frame_count() const { return frames_.size(); }
  const std::vector<FrameHeader>& frames() const { return frames_; }

 private:
  enum class Layout { virtual_frames, contiguous };
  std::filesystem::path results_path() const { return folder_ / "results.h5"; }
  std::filesystem::path frames_path() const { return folder_ / "frames"; }
  std::filesystem::path frame_path(std::size_t index) const;
  void split_finished_results();
  void collect_frames(double resume_time);
  void write_results(Layout layout) const;

  std::filesystem::path folder_;
  Provenance provenance_;
  std::vector<FieldSpec> fields_;
  std::vector<ColumnSpec> columns_;
  std::vector<std::string> material_names_;
  std::vector<FrameHeader> frames_;
};

}  // namespace sluice
