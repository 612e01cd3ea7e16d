// The command `place-vpls`.
#pragma once

namespace CLI {
class App;
}

namespace cli {

void addPlaceVpls(CLI::App& app);

}  // namespace cli
