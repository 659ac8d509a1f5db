// HDF5 files that another program wrote: as many items as it pleases, where one is asked for.

#include <gtest/gtest.h>
#include <hdf5.h>

#include <string>
#include <vector>

#include "hil/trace/hdf5_io.h"
#include "tests/support/folder_test.h"

namespace forcegate {
namespace {

class ForeignHdf5 : public FolderTest {
 protected:
  std::filesystem::path sound() {
    Trace trace;
    trace.time_bases.emplace_back();
    trace.time_bases[0].t_s = {0.0, 1.0};
    trace.channels = {{"F_ref", "N", "force", 0, {1.0, 2.0}, {}}};
    EXPECT_TRUE(write_hdf5(trace, folder_ / "a.h5"));
    return folder_ / "a.h5";
  }
  static hid_t many(hsize_t n) { return H5Screate_simple(1, &n, nullptr); }
};

TEST_F(ForeignHdf5, AnAttributeOfManyNumbersIsNone) {
  const auto path = sound();
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), space = many(6000);
  ASSERT_GE(H5Adelete(file, "format"), 0);
  const hid_t attribute = H5Acreate2(file, "format", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT);
  const std::vector<double> ones(6000, 1.0);
  ASSERT_GE(H5Awrite(attribute, H5T_NATIVE_DOUBLE, ones.data()), 0);
  H5Aclose(attribute);
  H5Sclose(space);
  H5Fclose(file);
  const auto read = read_hdf5(path);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::parse) << read.error().to_text();
}

TEST_F(ForeignHdf5, TextsBesideTheTraceAreLeftAloneWhereTheyAreMany) {
  constexpr hsize_t kTexts = 100000;
  constexpr std::size_t kLength = 64;
  const auto path = sound();
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), space = many(kTexts), type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, kLength);
  const hid_t meta = H5Lexists(file, "meta", H5P_DEFAULT) > 0 ? H5Gopen2(file, "meta", H5P_DEFAULT)
                                                              : H5Gcreate2(file, "meta", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t data = H5Dcreate2(meta, "log", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const std::string letters(kLength * kTexts, 'A');
  ASSERT_GE(H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, letters.data()), 0);
  H5Dclose(data);
  H5Gclose(meta);
  H5Tclose(type);
  H5Sclose(space);
  H5Fclose(file);
  const auto read = read_hdf5(path);
  ASSERT_TRUE(read) << read.error().to_text();
  EXPECT_EQ(read->trace.provenance.count("log"), 0U);
  EXPECT_EQ(read->trace.channels.at(0).value, (std::vector<double>{1.0, 2.0}));
}

}  // namespace
}  // namespace forcegate
