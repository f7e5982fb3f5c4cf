#include "backend/session/map_store.hpp"

#include "frontend/core/pcd.hpp"

namespace groundloop {

const RegistrationTarget& StoredMap::target() {
  if (!target_) target_.emplace(points_, options_);
  return *target_;
}

MapStore::MapStore(SessionFolder folder, const RegistrationOptions& options, std::size_t capacity)
    : folder_(std::move(folder)), options_(options), capacity_(capacity) {}

void MapStore::put(const LocalMap& map) {
  write_pcd(folder_.local_map(map.id), map.points);
  keep(std::make_shared<StoredMap>(map.id, map.points, options_));
}

std::shared_ptr<StoredMap> MapStore::get(int id) {
  for (auto it = recent_.begin(); it != recent_.end(); ++it) {
    if ((*it)->id() != id) continue;
    recent_.splice(recent_.begin(), recent_, it);
    return recent_.front();
  }
  return keep(std::make_shared<StoredMap>(id, read_pcd(folder_.local_map(id)), options_));
}

std::shared_ptr<StoredMap> MapStore::keep(std::shared_ptr<StoredMap> map) {
  recent_.push_front(std::move(map));
  while (recent_.size() > capacity_) recent_.pop_back();
  return recent_.front();
}

}  // namespace groundloop
