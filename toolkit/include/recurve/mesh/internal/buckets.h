#ifndef RECURVE_MESH_INTERNAL_BUCKETS_H
#define RECURVE_MESH_INTERNAL_BUCKETS_H

#include <recurve/core/types.h>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <vector>

namespace recurve::internal {

/// Items gathered by the bucket they fall into: items[begin[b]] .. items[begin[b + 1] - 1] are those of bucket b.
struct Buckets
{
  std::vector<Index> begin;
  std::vector<Index> items;

  Index bucket_count() const { return static_cast<Index>(begin.size()) - 1; }
};

/// gathers items by bucket. Called twice, `emit(put)` must call `put(bucket, item)` for the same items both times; it
/// may do so from several threads. The order of the items inside a bucket depends on the threads: sort them before use.
/// \par Complexity  linear; no memory beyond the result.
template <class Emit>
Buckets make_buckets(Index bucket_count, const Emit& emit)
{
  Buckets buckets;
  buckets.begin.assign(static_cast<std::size_t>(bucket_count) + 2, 0);
  // Counts stand two places on: after the sum, begin[b + 1] is where bucket b starts, and filling moves it to its end.
  Index* const counts = buckets.begin.data() + 2;
  Index* const ends = buckets.begin.data() + 1;
  emit([counts](Index bucket, Index) { std::atomic_ref(counts[bucket]).fetch_add(1, std::memory_order_relaxed); });
  for (Index b = 0; b < bucket_count; ++b)
    ends[b + 1] += ends[b];
  buckets.items.resize(static_cast<std::size_t>(ends[bucket_count]));
  Index* const items = buckets.items.data();
  emit([ends, items](Index bucket, Index item) {
    items[std::atomic_ref(ends[bucket]).fetch_add(1, std::memory_order_relaxed)] = item;
  });
  buckets.begin.pop_back();
  return buckets;
}

/// Buckets are worked on in runs of this many, whatever the number of threads, so that results gathered run by run come
/// in one order. Large enough to make the cost of a run vanish, small enough to balance.
inline constexpr Index buckets_per_run = 4096;

/// calls `work(first_bucket, last_bucket, result)` for each run of buckets, in parallel, and returns the results in the
/// order of the runs.
template <class Result, class Work>
std::vector<Result> for_each_run(Index bucket_count, const Work& work)
{
  const Index run_count = (bucket_count + buckets_per_run - 1) / buckets_per_run;
  std::vector<Result> results(static_cast<std::size_t>(run_count));
  tbb::parallel_for(Index(0), run_count, [&](Index run) {
    const Index first = run * buckets_per_run;
    work(first, std::min(bucket_count, first + buckets_per_run), results[static_cast<std::size_t>(run)]);
  });
  return results;
}

} // namespace recurve::internal

#endif
