#include "common/multicast.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>

namespace tautline {

bool hasMulticastRoute(const std::string& lcm_url) {
  const std::string scheme = "udpm://";
  if (!lcm_url.starts_with(scheme)) return true;
  const std::string address =
      lcm_url.substr(scheme.size(), lcm_url.find_first_of(":?", scheme.size()) - scheme.size());
  sockaddr_in group{};
  group.sin_family = AF_INET;
  group.sin_port =
      htons(std::uint16_t{7667});  // any: connecting a datagram socket only looks up the route
  if (inet_pton(AF_INET, address.c_str(), &group.sin_addr) != 1) return true;
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return false;
  const bool reachable =
      ::connect(fd, reinterpret_cast<const sockaddr*>(&group), sizeof(group)) == 0;
  ::close(fd);
  return reachable;
}

}  // namespace tautline
