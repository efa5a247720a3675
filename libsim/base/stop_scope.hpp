// How kernels that are called from everywhere learn that their work is to end.
#pragma once

namespace modcal {

class StopToken;

/// As long as it lives, this thread listens to the wish of a token, beside those that it listens to
/// already: throw_if_stopped() throws once one is made. for_each_task() hands the wishes on to the
/// threads that it spreads tasks over. The token must outlive this.
class StopScope {
 public:
  explicit StopScope(const StopToken& stop) : StopScope(&stop, here()) {}
  /// Listens to what another thread does; null: nothing. It must wait for this one.
  explicit StopScope(const StopScope* of_another) : StopScope(nullptr, of_another) {}
  ~StopScope();
  StopScope(const StopScope&) = delete;
  StopScope& operator=(const StopScope&) = delete;

  /// The innermost of this thread; null: there is none.
  static const StopScope* here();
  bool requested() const;

 private:
  StopScope(const StopToken* stop, const StopScope* outer);
  const StopToken* stop_;
  const StopScope* outer_;
  const StopScope* before_;
};

/// Throws Interrupted where a wish that this thread listens to was made: polled before every
/// transform of a record, every evaluation and some blocks of long loops.
void throw_if_stopped();

}  // namespace modcal
