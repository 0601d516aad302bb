// One run of Qhull, whose memory is given back.
#pragma once

#include <libqhull_r/qhull_ra.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace manyhands::internal {

/// Facets of a convex hull (Barber, Dobkin and Huhdanpaa, The Quickhull Algorithm for Convex Hulls, ACM TOMS 1996).
class QhullRun {
 public:
  QhullRun() { qh_zero(&qh_, log_.get()); }
  QhullRun(const QhullRun&) = delete;
  QhullRun& operator=(const QhullRun&) = delete;
  ~QhullRun() {
    qh_freeqhull(&qh_, !qh_ALL);
    int blocks = 0, bytes = 0;
    qh_memfreeshort(&qh_, &blocks, &bytes);
  }

  /// Of `count` points of `dimension` numbers each; they outlive the run, and Qhull may write to them. Whether there is
  /// a hull: flat clouds have none.
  [[nodiscard]] bool build(double* points, int count, int dimension, std::string options) {
    return qh_new_qhull(&qh_, dimension, count, points, False, options.data(), nullptr, log_.get()) == 0;
  }
  [[nodiscard]] qhT* get() { return &qh_; }

  [[nodiscard]] std::vector<facetT*> facets() const {
    std::vector<facetT*> all;
    for (facetT* facet = qh_.facet_list; facet != nullptr && facet->next != nullptr; facet = facet->next)
      all.push_back(facet);
    return all;
  }

 private:
  qhT qh_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> log_{std::tmpfile(), std::fclose};
};

}  // namespace manyhands::internal
