// "json": the stored form, all other views can be made from it again.

#include "hil/interface/reporter.h"
#include "hil/report/result_json.h"

namespace forcegate {
namespace {

const Registration<ReporterKind> kRegistered{
    {"json", "result.json", "every field, for machines (format 1, docs/schema/result.schema.json)", to_json}};

}  // namespace
}  // namespace forcegate
