#pragma once

#include "hil/diagnose/engine.h"
#include "hil/model/model.h"

namespace forcegate::diagnose {

// A model that is asked about as the verbs ask, by one thread.
inline EngineOptions options_of(const Model& model) {
  EngineOptions options;
  options.threads = 1;
  options.law = model.law;
  options.in_model = model.effect_names();
  options.model_effects = model.effects;
  return options;
}

}  // namespace forcegate::diagnose
