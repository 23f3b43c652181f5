#ifndef RECURVE_SURFACE_INTERNAL_VERTEX_FIT_STORE_H
#define RECURVE_SURFACE_INTERNAL_VERTEX_FIT_STORE_H

#include <recurve/core/types.h>
#include <recurve/surface/vertex_fit.h>

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

namespace recurve::internal::surface {

/// Room for the coefficients of many fits, which stay where they are put. One thread fills it.
class Coefficient_room
{
public:
  std::span<const double> keep(std::span<const double> coefficients)
  {
    if (free_.size() < coefficients.size())
    {
      blocks_.push_back(std::make_unique_for_overwrite<double[]>(numbers_per_block));
      free_ = {blocks_.back().get(), numbers_per_block};
    }
    const std::span<double> kept = free_.first(coefficients.size());
    std::copy(coefficients.begin(), coefficients.end(), kept.begin());
    free_ = free_.subspan(coefficients.size());
    return kept;
  }

private:
  static constexpr std::size_t numbers_per_block = 32768; ///< 256 kB, of which the system gives what is written to

  std::vector<std::unique_ptr<double[]>> blocks_;
  std::span<double> free_;
};

/// Keeps the fits of all vertices of a surface, each with as many coefficients as it has. Memory is first written to by
/// the threads that fit: to clear it before would take one thread as long as it takes many to fit.
class Vertex_fit_store
{
public:
  explicit Vertex_fit_store(std::size_t count)
    : fits_(std::allocator<Vertex_fit>().allocate(count), Deallocate{count}), count_(count)
  {}

  /// that of the calling thread.
  Coefficient_room& room() { return rooms_.local(); }

  /// Several threads may set fits of different vertices. A fit that is set again takes new room: these are few.
  void set(Index vertex, const Vertex_fit& fit, Coefficient_room& room)
  {
    Vertex_fit* const place = std::construct_at(fits_.get() + vertex, fit);
    place->coefficients = fit.degree > 0 ? room.keep(fit.coefficients) : flat_coefficients();
  }

  const Vertex_fit& operator[](Index vertex) const { return fits_.get()[vertex]; }

  /// \pre each fit was set.
  std::span<const Vertex_fit> all() const { return {fits_.get(), count_}; }

private:
  struct Deallocate
  {
    std::size_t count;
    void operator()(Vertex_fit* fits) const { std::allocator<Vertex_fit>().deallocate(fits, count); }
  };
  static_assert(std::is_trivially_destructible_v<Vertex_fit>);

  static std::span<const double> flat_coefficients() { return {&Vertex_fit::no_height, 1}; }

  std::unique_ptr<Vertex_fit, Deallocate> fits_;
  std::size_t count_;
  tbb::enumerable_thread_specific<Coefficient_room> rooms_;
};

} // namespace recurve::internal::surface

#endif
