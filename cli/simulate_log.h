#pragma once

namespace CLI {
class App;
}

namespace hydroscope {

/// `simulate log`: a recorded log, sent as if its machine were at work now.
void AddSimulateLog(CLI::App& simulate, int& exit_code);

}  // namespace hydroscope
