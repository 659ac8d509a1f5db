#include "hil/app/add.h"

#include "hil/app/write_file.h"

namespace forcegate {

Result<diagnose::Refit> add_request(const AddRequest& request) {
  FORCEGATE_TRY(diagnose::Refit refit, fit_request(request.campaign, request.effect));
  if (!request.output.empty())
    FORCEGATE_CHECK_OK(write_file_atomically(request.output, write_model(refit.model)));
  return refit;
}

}  // namespace forcegate
