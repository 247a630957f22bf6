#include "core/output/hdf5_file.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <type_traits>

namespace sluice {

namespace {

template <class T>
hid_t native_type() {
  if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
  if constexpr (std::is_same_v<T, std::int32_t>) return H5T_NATIVE_INT32;
  if constexpr (std::is_same_v<T, std::int64_t>) return H5T_NATIVE_INT64;
  if constexpr (std::is_same_v<T, std::uint8_t>) return H5T_NATIVE_UINT8;
}

/// The innermost message of the HDF5 error stack.
std::string innermost_error() {
  std::string text;
  const auto keep = [](unsigned, const H5E_error2_t* error, void* out) -> herr_t {
    if (error->desc != nullptr) *static_cast<std::string*>(out) = error->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, keep, &text);
  // An error of the system comes with time, descriptor and buffer; its message says enough.
  const std::string mark = "error message = '";
  if (const auto at = text.find(mark); at != std::string::npos)
    text = text.substr(at + mark.size(), text.find('\'', at + mark.size()) - at - mark.size());
  return text;
}

std::size_t row_length(const Hdf5File::Shape& shape) {
  return std::accumulate(shape.begin() + 1, shape.end(), std::size_t{1}, std::multiplies<>());
}

Hdf5Id make_space(const Hdf5File::Shape& shape) {
  const std::vector<hsize_t> extent(shape.begin(), shape.end());
  return {H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), H5Sclose};
}

Hdf5Id text_type(std::size_t size) {
  Hdf5Id type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, std::max<std::size_t>(size, 1));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

std::string up_to_null(const char* data, std::size_t size) { return {data, std::find(data, data + size, '\0')}; }

}  // namespace

Hdf5File::Hdf5File(const std::filesystem::path& path, Mode mode) : name_(path.string()) {
  // Every file is closed by its object. At exit HDF5 would try once more to write what a full disk refused, and crash.
  [[maybe_unused]] static const herr_t once = H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors are thrown, not printed
  // The format of HDF5 1.10 carries checksums of its own for everything but the raw data.
  const Hdf5Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
  const hid_t file = mode == Mode::create ? H5Fcreate(name_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access)
                                          : H5Fopen(name_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  file_ = Hdf5Id(check(file, mode == Mode::create ? "cannot be created" : "cannot be opened"), H5Fclose);
}

void Hdf5File::close() { check(file_.close(), "cannot be completed"); }

hid_t Hdf5File::check(hid_t result, const std::string& what) const {
  if (result >= 0) return result;
  const std::string reason = innermost_error();
  throw std::runtime_error(name_ + ": " + what + (reason.empty() ? "" : " (" + reason + ")"));
}

bool Hdf5File::contains(const std::string& object) const {
  // HDF5 demands that every group on the way exists.
  for (std::size_t slash = object.find('/', 1);; slash = object.find('/', slash + 1)) {
    if (H5Lexists(file_, object.substr(0, slash).c_str(), H5P_DEFAULT) <= 0) return false;
    if (slash == std::string::npos) return true;
  }
}

std::vector<std::string> Hdf5File::members(const std::string& group) const {
  const Hdf5Id opened(check(H5Gopen2(file_, group.c_str(), H5P_DEFAULT), group + " cannot be opened"), H5Gclose);
  std::vector<std::string> names;
  const auto collect = [](hid_t, const char* name, const H5L_info_t*, void* out) -> herr_t {
    static_cast<std::vector<std::string>*>(out)->push_back(name);
    return 0;
  };
  check(H5Literate(opened, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &names), group + " cannot be listed");
  return names;
}

void Hdf5File::create_group(const std::string& group) {
  const Hdf5Id links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links, 1);
  const Hdf5Id made(check(H5Gcreate2(file_, group.c_str(), links, H5P_DEFAULT, H5P_DEFAULT), group + " cannot be made"),
                    H5Gclose);
}

Hdf5Id Hdf5File::open_dataset(const std::string& dataset) const {
  return {check(H5Dopen2(file_, dataset.c_str(), H5P_DEFAULT), dataset + " cannot be opened"), H5Dclose};
}

Hdf5Id Hdf5File::create_dataset(const std::string& dataset, hid_t type, const Shape& shape, hid_t properties) {
  const Hdf5Id links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(links, 1);
  const Hdf5Id space = make_space(shape);
  return {check(H5Dcreate2(file_, dataset.c_str(), type, space, links, properties, H5P_DEFAULT),
                dataset + " cannot be made"),
          H5Dclose};
}

Hdf5File::Shape Hdf5File::shape(const std::string& dataset) const {
  const Hdf5Id opened = open_dataset(dataset);
  const Hdf5Id space(H5Dget_space(opened), H5Sclose);
  std::vector<hsize_t> extent(static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space))));
  if (!extent.empty()) H5Sget_simple_extent_dims(space, extent.data(), nullptr);
  return {extent.begin(), extent.end()};
}

Hdf5Id Hdf5File::select_rows(hid_t dataset, const std::string& name, std::size_t first_row, std::size_t rows) const {
  Hdf5Id space(H5Dget_space(dataset), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 1) throw std::runtime_error(name_ + ": " + name + " has no rows");
  std::vector<hsize_t> start(static_cast<std::size_t>(rank), 0), count(start);
  H5Sget_simple_extent_dims(space, count.data(), nullptr);
  if (first_row + rows > count[0])
    throw std::runtime_error(name_ + ": " + name + " has " + std::to_string(count[0]) + " rows; rows up to " +
                             std::to_string(first_row + rows) + " were expected");
  start[0] = first_row;
  count[0] = rows;
  check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr),
        name + ": rows cannot be selected");
  return space;
}

template <class T>
void Hdf5File::create(const std::string& dataset, const Shape& shape) {
  create_dataset(dataset, native_type<T>(), shape, H5P_DEFAULT);
}

template <class T>
void Hdf5File::write_rows(const std::string& dataset, std::size_t first_row, std::span<const T> values) {
  if (values.empty()) return;
  const Hdf5Id opened = open_dataset(dataset);
  const Hdf5Id rows = select_rows(opened, dataset, first_row, values.size() / row_length(shape(dataset)));
  const Hdf5Id memory = make_space({values.size()});
  check(H5Dwrite(opened, native_type<T>(), memory, rows, H5P_DEFAULT, values.data()), dataset + " cannot be written");
}

template <class T>
std::vector<T> Hdf5File::read_rows(const std::string& dataset, std::size_t first_row, std::size_t rows) const {
  if (rows == 0) return {};
  const Hdf5Id opened = open_dataset(dataset);
  const Hdf5Id selected = select_rows(opened, dataset, first_row, rows);
  std::vector<T> values(rows * row_length(shape(dataset)));
  const Hdf5Id memory = make_space({values.size()});
  check(H5Dread(opened, native_type<T>(), memory, selected, H5P_DEFAULT, values.data()), dataset + " cannot be read");
  return values;
}

template <class T>
void Hdf5File::write(const std::string& dataset, const std::vector<T>& values, Shape shape) {
  if (shape.empty()) shape = {values.size()};
  create<T>(dataset, shape);
  write_rows<T>(dataset, 0, values);
}

template <class T>
std::vector<T> Hdf5File::read(const std::string& dataset) const {
  const Shape extent = shape(dataset);
  if (extent.empty()) throw std::runtime_error(name_ + ": " + dataset + " has no rows");
  return read_rows<T>(dataset, 0, extent[0]);
}

template <class T>
void Hdf5File::create_virtual(const std::string& dataset, const Shape& shape, std::span<const VirtualPart> parts) {
  const Hdf5Id properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const Hdf5Id space = make_space(shape);
  std::vector<hsize_t> start(shape.size(), 0), count(shape.begin(), shape.end());
  for (const VirtualPart& part : parts) {
    if (part.rows == 0) continue;
    start[0] = part.first_row;
    count[0] = part.rows;
    check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr),
          dataset + ": rows cannot be selected");
    const Hdf5Id source = make_space({count.begin(), count.end()});
    check(H5Pset_virtual(properties, space, part.file.c_str(), part.dataset.c_str(), source),
          dataset + " cannot be mapped to " + part.file);
  }
  create_dataset(dataset, native_type<T>(), shape, properties);
}

bool Hdf5File::is_virtual(const std::string& dataset) const {
  const Hdf5Id opened = open_dataset(dataset);
  const Hdf5Id properties(H5Dget_create_plist(opened), H5Pclose);
  return H5Pget_layout(properties) == H5D_VIRTUAL;
}

bool Hdf5File::is_floating_point(const std::string& dataset) const {
  const Hdf5Id opened = open_dataset(dataset);
  const Hdf5Id type(H5Dget_type(opened), H5Tclose);
  return H5Tget_class(type) == H5T_FLOAT;
}

void Hdf5File::write_text(const std::string& dataset, const std::string& text) { write_texts(dataset, {text}); }

std::string Hdf5File::read_text(const std::string& dataset) const {
  const auto texts = read_texts(dataset);
  return texts.empty() ? "" : texts.front();
}

void Hdf5File::write_texts(const std::string& dataset, const std::vector<std::string>& texts) {
  std::size_t size = 1;
  for (const auto& text : texts) size = std::max(size, text.size());
  std::string packed;
  for (const auto& text : texts) packed.append(text).append(size - text.size(), '\0');
  const Hdf5Id type = text_type(size);
  const Hdf5Id made = create_dataset(dataset, type, {texts.size()}, H5P_DEFAULT);
  if (texts.empty()) return;
  check(H5Dwrite(made, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, packed.data()), dataset + " cannot be written");
}

std::vector<std::string> Hdf5File::read_texts(const std::string& dataset) const {
  const Hdf5Id opened = open_dataset(dataset);
  const Hdf5Id type(H5Dget_type(opened), H5Tclose);
  if (H5Tget_class(type) != H5T_STRING) throw std::runtime_error(name_ + ": " + dataset + " is not text");
  const std::size_t size = H5Tget_size(type);
  std::vector<std::string> texts(shape(dataset).at(0));
  std::vector<char> packed(size * texts.size());
  if (texts.empty()) return texts;
  check(H5Dread(opened, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, packed.data()), dataset + " cannot be read");
  for (std::size_t i = 0; i < texts.size(); ++i) texts[i] = up_to_null(packed.data() + i * size, size);
  return texts;
}

void Hdf5File::write_attribute(const std::string& object, const std::string& name, hid_t type, const Hdf5Id& space,
                               const void* data) {
  const Hdf5Id made(
      check(H5Acreate_by_name(file_, object.c_str(), name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
            object + ": attribute " + name + " cannot be made"),
      H5Aclose);
  check(H5Awrite(made, type, data), object + ": attribute " + name + " cannot be written");
}

void Hdf5File::set_attribute(const std::string& object, const std::string& name, const std::string& text) {
  // VTK compares the Type attribute by its exact length, so none is added. ASCII where possible: older readers of the
  // VTKHDF layout know no other character set.
  const Hdf5Id type = text_type(text.size());
  if (std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 128; }))
    H5Tset_cset(type, H5T_CSET_ASCII);
  write_attribute(object, name, type, {H5Screate(H5S_SCALAR), H5Sclose}, text.c_str());
}

void Hdf5File::set_attribute(const std::string& object, const std::string& name, double value) {
  write_attribute(object, name, H5T_NATIVE_DOUBLE, {H5Screate(H5S_SCALAR), H5Sclose}, &value);
}

void Hdf5File::set_attribute(const std::string& object, const std::string& name, std::int64_t value) {
  write_attribute(object, name, H5T_NATIVE_INT64, {H5Screate(H5S_SCALAR), H5Sclose}, &value);
}

void Hdf5File::set_attribute(const std::string& object, const std::string& name, const std::vector<double>& values) {
  write_attribute(object, name, H5T_NATIVE_DOUBLE, make_space({values.size()}), values.data());
}

void Hdf5File::set_attribute(const std::string& object, const std::string& name,
                             const std::vector<std::int64_t>& values) {
  write_attribute(object, name, H5T_NATIVE_INT64, make_space({values.size()}), values.data());
}

bool Hdf5File::has_attribute(const std::string& object, const std::string& name) const {
  return H5Aexists_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT) > 0;
}

Hdf5Id Hdf5File::open_attribute(const std::string& object, const std::string& name) const {
  return {check(H5Aopen_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
                object + ": attribute " + name + " is missing"),
          H5Aclose};
}

std::string Hdf5File::text_attribute(const std::string& object, const std::string& name) const {
  const Hdf5Id attribute = open_attribute(object, name);
  const Hdf5Id type(H5Aget_type(attribute), H5Tclose);
  if (H5Tget_class(type) != H5T_STRING)
    throw std::runtime_error(name_ + ": " + object + ": attribute " + name + " is not text");
  std::vector<char> data(H5Tget_size(type));
  check(H5Aread(attribute, type, data.data()), object + ": attribute " + name + " cannot be read");
  return up_to_null(data.data(), data.size());
}

std::vector<double> Hdf5File::real_attribute(const std::string& object, const std::string& name) const {
  const Hdf5Id attribute = open_attribute(object, name);
  const Hdf5Id space(H5Aget_space(attribute), H5Sclose);
  std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  check(H5Aread(attribute, H5T_NATIVE_DOUBLE, values.data()), object + ": attribute " + name + " cannot be read");
  return values;
}

std::vector<std::int64_t> Hdf5File::integer_attribute(const std::string& object, const std::string& name) const {
  const Hdf5Id attribute = open_attribute(object, name);
  const Hdf5Id space(H5Aget_space(attribute), H5Sclose);
  std::vector<std::int64_t> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  check(H5Aread(attribute, H5T_NATIVE_INT64, values.data()), object + ": attribute " + name + " cannot be read");
  return values;
}

#define SLUICE_INSTANTIATE(T)                                                                         \
  template void Hdf5File::create<T>(const std::string&, const Shape&);                                \
  template void Hdf5File::write_rows<T>(const std::string&, std::size_t, std::span<const T>);         \
  template std::vector<T> Hdf5File::read_rows<T>(const std::string&, std::size_t, std::size_t) const; \
  template void Hdf5File::write<T>(const std::string&, const std::vector<T>&, Shape);                 \
  template std::vector<T> Hdf5File::read<T>(const std::string&) const;                                \
  template void Hdf5File::create_virtual<T>(const std::string&, const Shape&, std::span<const VirtualPart>);
SLUICE_INSTANTIATE(double)
SLUICE_INSTANTIATE(std::int32_t)
SLUICE_INSTANTIATE(std::int64_t)
SLUICE_INSTANTIATE(std::uint8_t)
#undef SLUICE_INSTANTIATE

}  // namespace sluice
