#pragma once

#include "models/machine_draft.h"

namespace hydroscope {

/// Any log may be of a machine of the user's own; a balance of forces is proposed where there is a force.
extern const DraftRules kOwnDraft;

}  // namespace hydroscope
