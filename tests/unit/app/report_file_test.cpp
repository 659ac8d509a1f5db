// The file of a stored result's view.

#include <gtest/gtest.h>

#include <fstream>

#include "hil/app/stored/report.h"
#include "hil/base/read_file.h"
#include "hil/report/result_json.h"
#include "tests/support/folder_test.h"
#include "tests/support/sample_run.h"

namespace forcegate {
namespace {

class ReportFile : public FolderTest {};

TEST_F(ReportFile, OfEveryViewReplacesItsOwnAndNoOther) {
  for (const sample::Variant variant : {sample::Variant::accept, sample::Variant::reject, sample::Variant::no_decision, sample::Variant::rig_fault}) {
    const auto result = put("result.json", to_json(sample::run(variant, 60.0)));
    for (const std::string& view : report_formats()) {
      ReportRequest request;
      request.result = result;
      request.format = view;
      request.output = folder_ / ("out." + view);
      std::filesystem::remove(request.output);
      for (int time = 0; time < 2; ++time) {
        const auto own = render_report(request);
        EXPECT_TRUE(own) << view << ": " << own.error().to_text();
      }
      put("out." + view, "what I wrote last night");
      const auto foreign = render_report(request);
      ASSERT_FALSE(foreign) << view;
      EXPECT_EQ(foreign.error().code, ErrorCode::usage);
      request.overwrite = true;
      EXPECT_TRUE(render_report(request)) << view;
    }
  }
}

}  // namespace
}  // namespace forcegate
