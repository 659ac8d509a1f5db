// What is meant by the name of a model that a person gives.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/app/model/model_input.h"
#include "tests/support/folder_test.h"

namespace forcegate {
namespace {

using testing::HasSubstr;

class LoadModel : public FolderTest {};

TEST_F(LoadModel, SaysOfARecordingThatItIsNoModelFile) {
  put("r.csv", "t_s,F_ref_N,U_V\n0,1,2\n0.1,2,3\n");
  const auto model = load_model((folder_ / "r.csv").string());
  ASSERT_FALSE(model);
  EXPECT_EQ(model.error().text, "this is a recording and no model file");
  EXPECT_THAT(model.error().hint, HasSubstr("forcegate add -o"));
}

}  // namespace
}  // namespace forcegate
