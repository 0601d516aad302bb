#include "manyhands/kinematics/manipulability.h"

#include <algorithm>
#include <type_traits>
#include <vector>

#include "manyhands/base/assert.h"
#include "manyhands/math/instantiate.h"

namespace manyhands {

template <Real R>
void manipulability_of_rows(VelocityPart part, std::size_t n, std::size_t nv, std::span<const R> J,
                            const ManipulabilityRows<R>& found) {
  using T = std::conditional_t<std::same_as<R, float>, NativeLanes, R>;
  constexpr std::size_t W = width_v<T>;
  const std::size_t m = rows_of(part), numbers = 6 * nv;
  MANYHANDS_ASSERT(J.size() == n * numbers && found.lengths.size() == n * m && found.axes.size() == n * m * m);
  std::vector<T> block(numbers), lengths(m), axes(m * m);
  for (std::size_t first = 0; first < n; first += W) {
    const std::size_t count = std::min(W, n - first);
    for (std::size_t k = 0; k < W; ++k) {
      const R* row = J.data() + (first + std::min(k, count - 1)) * numbers;  // spare lanes repeat the last
      for (std::size_t i = 0; i < numbers; ++i) set_lane(block[i], static_cast<int>(k), row[i]);
    }
    const Manipulability<T> one = manipulability(part, nv, block.data(), lengths.data(), axes.data());
    for (std::size_t k = 0; k < count; ++k) {
      const auto at = static_cast<int>(k);
      found.measure[first + k] = lane(one.measure, at);
      found.condition[first + k] = lane(one.condition, at);
      found.isotropy[first + k] = lane(one.isotropy, at);
      for (std::size_t i = 0; i < m; ++i) found.lengths[(first + k) * m + i] = lane(lengths[i], at);
      for (std::size_t i = 0; i < m * m; ++i) found.axes[(first + k) * m * m + i] = lane(axes[i], at);
    }
  }
}

template void manipulability_of_rows<double>(VelocityPart, std::size_t, std::size_t, std::span<const double>,
                                             const ManipulabilityRows<double>&);
template void manipulability_of_rows<float>(VelocityPart, std::size_t, std::size_t, std::span<const float>,
                                            const ManipulabilityRows<float>&);

}  // namespace manyhands
