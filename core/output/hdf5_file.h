/// Hdf5File: the part of HDF5 that results and checkpoints need, with errors as exceptions.
///
/// Every function throws std::runtime_error, with the name of the file and of the object, when HDF5 reports an error.
/// Element types: double, std::int32_t, std::int64_t, std::uint8_t.
#pragma once

#include <hdf5.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace sluice {

/// Owns an HDF5 identifier of any kind.
class Hdf5Id {
 public:
  using Closer = herr_t (*)(hid_t);
  Hdf5Id() = default;
  Hdf5Id(hid_t id, Closer closer) : id_(id), closer_(closer) {}
  Hdf5Id(Hdf5Id&& other) noexcept : id_(std::exchange(other.id_, -1)), closer_(other.closer_) {}
  Hdf5Id& operator=(Hdf5Id&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(closer_, other.closer_);
    return *this;
  }
  ~Hdf5Id() { close(); }

  operator hid_t() const { return id_; }
  bool valid() const { return id_ >= 0; }
  herr_t close() { return id_ >= 0 ? closer_(std::exchange(id_, -1)) : 0; }

 private:
  hid_t id_ = -1;
  Closer closer_ = nullptr;
};

/// Rows of a virtual dataset that lie in a dataset of another file.
struct VirtualPart {
  std::string file;     ///< relative to the folder of the file with the virtual dataset
  std::string dataset;  ///< all of its rows are presented
  std::size_t first_row = 0;
  std::size_t rows = 0;
};

class Hdf5File {
 public:
  enum class Mode { read, create };
  using Shape = std::vector<std::size_t>;

  Hdf5File(const std::filesystem::path& path, Mode mode);
  /// Closes, and reports what could not be written; the destructor closes in silence.
  void close();
  const std::string& name() const { return name_; }

  bool contains(const std::string& object) const;
  /// Names of the members of a group, sorted.
  std::vector<std::string> members(const std::string& group) const;
  void create_group(const std::string& group);

  Shape shape(const std::string& dataset) const;
  /// A contiguous dataset; missing groups are made.
  template <class T>
  void create(const std::string& dataset, const Shape& shape);
  /// Rows of a dataset of any rank, beginning at `first_row`; the number of rows follows from the number of values.
  template <class T>
  void write_rows(const std::string& dataset, std::size_t first_row, std::span<const T> values);
  template <class T>
  std::vector<T> read_rows(const std::string& dataset, std::size_t first_row, std::size_t rows) const;
  /// `create` and `write_rows` in one; an empty shape means one-dimensional.
  template <class T>
  void write(const std::string& dataset, const std::vector<T>& values, Shape shape = {});
  template <class T>
  std::vector<T> read(const std::string& dataset) const;
  /// A dataset whose rows lie in other files. Rows that no part presents read as zero.
  template <class T>
  void create_virtual(const std::string& dataset, const Shape& shape, std::span<const VirtualPart> parts);
  bool is_virtual(const std::string& dataset) const;
  bool is_floating_point(const std::string& dataset) const;

  /// UTF-8 text; a null byte ends it.
  void write_text(const std::string& dataset, const std::string& text);
  std::string read_text(const std::string& dataset) const;
  void write_texts(const std::string& dataset, const std::vector<std::string>& texts);
  std::vector<std::string> read_texts(const std::string& dataset) const;

  /// Attributes of a group or dataset; one value makes a scalar, unless it comes as a vector.
  void set_attribute(const std::string& object, const std::string& name, const std::string& text);
  void set_attribute(const std::string& object, const std::string& name, double value);
  void set_attribute(const std::string& object, const std::string& name, std::int64_t value);
  void set_attribute(const std::string& object, const std::string& name, const std::vector<double>& values);
  void set_attribute(const std::string& object, const std::string& name, const std::vector<std::int64_t>& values);
  bool has_attribute(const std::string& object, const std::string& name) const;
  std::string text_attribute(const std::string& object, const std::string& name) const;
  std::vector<double> real_attribute(const std::string& object, const std::string& name) const;
  std::vector<std::int64_t> integer_attribute(const std::string& object, const std::string& name) const;

 private:
  hid_t check(hid_t result, const std::string& what) const;
  Hdf5Id open_dataset(const std::string& dataset) const;
  Hdf5Id open_attribute(const std::string& object, const std::string& name) const;
  Hdf5Id create_dataset(const std::string& dataset, hid_t type, const Shape& shape, hid_t properties);
  Hdf5Id select_rows(hid_t dataset, const std::string& name, std::size_t first_row, std::size_t rows) const;
  void write_attribute(const std::string& object, const std::string& name, hid_t type, const Hdf5Id& space,
                       const void* data);

  std::string name_;
  Hdf5Id file_;
};

}  // namespace sluice
