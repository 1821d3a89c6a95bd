# What nearly every source includes, compiled once for each kind of target. A source still names what it uses: it must
# compile with -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON too.
set(BESPOKE_PRECOMPILED_HEADERS
  <algorithm> <array> <cmath> <cstddef> <cstdint> <functional> <iostream> <memory> <optional> <sstream> <string>
  <utility> <vector>
  <Eigen/Dense>)
