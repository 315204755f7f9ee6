// `weft view`: another program, which needs a window.
#pragma once

#include "samples/weft/commands.h"

namespace weft::command {

/// Becomes weft_view, which lies beside this program, with the arguments from `view` on. Returns where there is none: it complains.
Exit view(char** arguments);

}  // namespace weft::command
