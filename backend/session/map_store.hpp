// Local maps on disk with a small cache of those in use, so that memory does not grow with the
// recording.
#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <optional>

#include "backend/registration/registration.hpp"
#include "backend/session/session.hpp"
#include "frontend/local_maps/local_map.hpp"

namespace groundloop {

/// A local map ready to be registered: its points, and the search structure once it was asked for.
class StoredMap {
 public:
  StoredMap(int id, Points points, const RegistrationOptions& options)
      : id_(id), points_(std::move(points)), options_(options) {}
  [[nodiscard]] int id() const { return id_; }
  [[nodiscard]] const Points& points() const { return points_; }
  /// Built on first use; not to be called from two threads at once.
  [[nodiscard]] const RegistrationTarget& target();

 private:
  int id_;
  Points points_;
  RegistrationOptions options_;
  std::optional<RegistrationTarget> target_;
};

class MapStore {
 public:
  MapStore(SessionFolder folder, const RegistrationOptions& options, std::size_t capacity = 6);

  /// Writes the map to the session and keeps it in the cache.
  void put(const LocalMap& map);
  /// The map, from the cache or from disk. Throws InputError naming the file where it cannot be
  /// read.
  [[nodiscard]] std::shared_ptr<StoredMap> get(int id);

 private:
  std::shared_ptr<StoredMap> keep(std::shared_ptr<StoredMap> map);

  SessionFolder folder_;
  RegistrationOptions options_;
  std::size_t capacity_;
  std::list<std::shared_ptr<StoredMap>> recent_;  // the latest first
};

}  // namespace groundloop
