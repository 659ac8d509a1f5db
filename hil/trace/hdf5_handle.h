#pragma once
// Owner of an HDF5 identifier. Included only by the .cpp files that speak HDF5.

#include <hdf5.h>

#include <mutex>
#include <string>
#include <utility>

namespace forcegate {

/// Debian's HDF5 is not thread-safe: every entry holds this lock. It also keeps the library from printing.
class Hdf5Lock {
 public:
  Hdf5Lock() : lock_(mutex()) {
    // a file that a full disk did not let close would be flushed once more when the program ends, and take it down
    [[maybe_unused]] static const herr_t once = H5dont_atexit();
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }

 private:
  static std::recursive_mutex& mutex() {
    static std::recursive_mutex m;
    return m;
  }
  std::lock_guard<std::recursive_mutex> lock_;
};

class Hdf5Handle {
 public:
  Hdf5Handle() = default;
  Hdf5Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Hdf5Handle() { reset(); }
  Hdf5Handle(Hdf5Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Hdf5Handle& operator=(Hdf5Handle&& other) noexcept {
    reset();
    id_ = std::exchange(other.id_, -1);
    close_ = other.close_;
    return *this;
  }
  operator hid_t() const { return id_; }
  bool good() const { return id_ >= 0; }
  /// False when closing reports an error, which for a file means that data did not reach the disk.
  bool reset() {
    const bool fine = id_ < 0 || close_(id_) >= 0;
    id_ = -1;
    return fine;
  }

 private:
  hid_t id_ = -1;
  herr_t (*close_)(hid_t) = nullptr;
};

}  // namespace forcegate
