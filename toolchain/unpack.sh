# shellcheck shell=bash
# Debian packages of any architecture, unpacked into a folder: no root, nothing installed. Sourced, never run; needs lib.sh.
# A private apt root (own state and cache) keeps the machine's own apt out of it; where packages come from is copied from
# the machine's apt configuration.

unpack_base=$PWD/build
apt_root() { echo "$unpack_base/apt-$1"; }  # apt_root ARCHITECTURE

# Of the machine's package sources, those of Debian itself, for any architecture.
debian_sources() { # debian_sources FOLDER
  local file codename
  codename=$(. /etc/os-release && echo "$VERSION_CODENAME")
  for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.list; do
    [[ -f $file ]] || continue
    grep -E "^deb .* $codename(-updates|-security)? (.* )?main( |\$)" "$file" | sed -E 's/arch=[^] ]+ ?//; s/\[ *\]//' || true
  done >"$1/debian.list"
  for file in /etc/apt/sources.list.d/*.sources; do
    [[ -f $file ]] || continue
    awk -v RS= -v codename="$codename" '
      $0 ~ "(^|\n)Suites:[^\n]*[ ]" codename "(-|[ \n]|$)" && /(^|\n)Components:[^\n]* main( |\n|$)/ {
        n = split($0, line, "\n")
        for (i = 1; i <= n; i++) if (line[i] !~ /^(Architectures:|#)/) print line[i]
        print ""
      }' "$file"
  done >"$1/debian.sources"
  [[ -s $1/debian.list || -s $1/debian.sources ]] || {
    echo "run: error: no package source for Debian $codename in /etc/apt; add one (man sources.list) and run this again" >&2
    return 1
  }
}

# private_apt ARCHITECTURE COMMAND…: apt-get or apt-cache on the private root.
private_apt() {
  local root command=$2 architecture=$1
  root=$(apt_root "$architecture")
  shift 2
  "$command" -qq -o APT::Architecture="$architecture" -o APT::Architectures::="$architecture" \
    -o Dir::State="$root/state" -o Dir::State::status="$root/state/status" -o Dir::Cache="$root/cache" \
    -o Dir::Etc::sourcelist=/dev/null -o Dir::Etc::sourceparts="$root/sources" \
    -o APT::Sandbox::User= -o APT::Install-Recommends=false -o Debug::NoLocking=true "$@"
}

# Makes the private root and reads the package lists.
update_apt_root() { # update_apt_root ARCHITECTURE
  local root
  root=$(apt_root "$1")
  rm -rf "$root/state"
  mkdir -p "$root"/state/lists/partial "$root"/cache/archives/partial "$root/sources"
  : >"$root/state/status"
  debian_sources "$root/sources" || return 1
  quietly private_apt "$1" apt-get update || {
    echo "run: error: apt cannot read the package lists for $1; is the network there? Try: apt-get update" >&2
    return 1
  }
}

# unpack_packages ARCHITECTURE FOLDER all|only PACKAGE…: unpacks the packages, with all or nothing of what they depend on.
# Does nothing if FOLDER already holds them. The kernel's metapackage stands for the kernel that it depends on.
unpack_packages() {
  local architecture=$1 folder=$2 depth=$3 root wanted package real
  shift 3
  wanted="$architecture $depth $*"
  [[ $(cat "$folder/.packages" 2>/dev/null) != "$wanted" ]] || return 0
  root=$(apt_root "$architecture")
  say "unpacking $* ($architecture) into build/${folder##*/}"
  update_apt_root "$architecture" || return 1
  rm -rf "$folder.new" "$root"/cache/archives/*.deb
  mkdir -p "$folder.new"
  if [[ $depth == all ]]; then
    quietly private_apt "$architecture" apt-get install -y --download-only "$@" || return 1
  else
    for package in "$@"; do
      real=$(private_apt "$architecture" apt-cache depends --no-recommends --no-suggests "$package" |
        sed -nE "s/^ *Depends: (linux-image-[0-9][^ ]*)\$/\1/p" | head -n 1)
      (cd "$root/cache/archives" && quietly private_apt "$architecture" apt-get download "${real:-$package}") || return 1
    done
  fi
  for package in "$root"/cache/archives/*.deb; do dpkg -x "$package" "$folder.new" || return 1; done
  rm -f "$root"/cache/archives/*.deb
  relative_links "$folder.new"
  echo "$wanted" >"$folder.new/.packages"
  rm -rf "$folder"
  mv "$folder.new" "$folder"
}

# Absolute symbolic links would lead out of the folder.
relative_links() { # relative_links FOLDER
  local link
  find "$1" -type l -lname '/*' | while read -r link; do
    ln -sfn --relative "$1$(readlink "$link")" "$link"
  done
}
