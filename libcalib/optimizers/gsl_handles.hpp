// Owners of what the GNU Scientific Library allocates.
#pragma once

#include <gsl/gsl_vector.h>

#include <memory>
#include <new>

namespace modcal {

template <auto kFree>
struct GslFree {
  template <typename Object>
  void operator()(Object* object) const {
    kFree(object);
  }
};

template <typename Object, auto kFree>
using GslHandle = std::unique_ptr<Object, GslFree<kFree>>;

using GslVector = GslHandle<gsl_vector, gsl_vector_free>;

/// Takes what an allocating function of the library returned; its error handler being off, a null
/// pointer says that memory ran out.
template <typename Handle>
Handle gsl_owned(typename Handle::pointer object) {
  if (object == nullptr) throw std::bad_alloc();
  return Handle(object);
}

inline GslVector gsl_vector_of(std::size_t size, double value) {
  auto vector = gsl_owned<GslVector>(gsl_vector_alloc(size));
  gsl_vector_set_all(vector.get(), value);
  return vector;
}

}  // namespace modcal
