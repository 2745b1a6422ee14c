#include "studies/rigs/test_body.h"

#include "deformation/model/organ_model.h"
#include "deformation/models.h"

namespace palpate::rigs {

TestBody::TestBody(const scene::Organ& organ, const geometry::OrganShape& shape, double period)
    : model_(std::make_unique<const deformation::OrganModel>(
          deformation::build_organ_model(organ, Vec3::Zero(), shape))),
      dynamics_(deformation::make_dynamics(organ, *model_, period)),
      state_(deformation::rest_state(*model_)) {}

double TestBody::mass() const {
  double sum = 0;
  for (const double mass : model_->masses) sum += mass;
  return sum;
}

}  // namespace palpate::rigs
