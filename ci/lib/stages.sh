# shellcheck shell=bash disable=SC2034
# Sourced by the scripts of ci/. Stages with their minutes, packages, one place for the number of jobs.
# Needs only bash, coreutils and apt.

export LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive
exec </dev/null

JOBS=${FORCEGATE_JOBS:-$(nproc)}
stage_names=() stage_seconds=() stage_results=()

# stage "name" command...: runs it, notes its time; returns its code.
stage() {
  local name=$1 begin=$SECONDS code=0
  shift
  printf '\n==> %s\n' "$name"
  "$@" || code=$?
  stage_names+=("$name") stage_seconds+=($((SECONDS - begin)))
  if ((code == 0)); then stage_results+=(ok); else stage_results+=("FAILED ($code)"); fi
  return "$code"
}

print_stages() {
  local i total=0
  printf '\n%-44s %8s  %s\n' stage minutes result
  for i in "${!stage_names[@]}"; do
    printf '%-44s %5d:%02d  %s\n' "${stage_names[i]}" $((stage_seconds[i] / 60)) $((stage_seconds[i] % 60)) \
      "${stage_results[i]}"
    total=$((total + stage_seconds[i]))
  done
  printf '%-44s %5d:%02d\n' total $((total / 60)) $((total % 60))
}

# install_missing FILE: apt-get install of the packages in FILE that are not there; nothing when all are.
install_missing() {
  local file=$1 name missing=() sudo=()
  command -v dpkg-query >/dev/null || {
    echo "error: this script installs Debian packages and there is no dpkg here" >&2
    echo "  help: use Debian 12, or install what $file names and run cmake by hand (CONTRIBUTING.md)" >&2
    return 2
  }
  while read -r name _; do
    case $name in '' | '#'*) continue ;; esac
    dpkg-query -W -f '${db:Status-Status}\n' "$name" 2>/dev/null | grep -qx installed || missing+=("$name")
  done <"$file"
  ((${#missing[@]} == 0)) && return 0
  echo "installing: ${missing[*]}"
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || {
      echo "error: these packages are missing and neither root nor sudo is there to install them" >&2
      echo "  help: as root, apt-get install ${missing[*]}" >&2
      return 2
    }
    sudo=(sudo)
  fi
  "${sudo[@]}" apt-get -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3 -qq update
  "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3 \
    install -y -qq --no-install-recommends "${missing[@]}"
}

# configure DIR OPTIONS...: runs cmake only when the options or the folder are new; the build reruns it by itself. What failed is run again:
# a folder that was never configured so must not be built, and tested, with the options before.
configure() {
  local dir=$1 options
  shift
  options="$*"
  if [ -f "$dir/build.ninja" ] && [ "$(cat "$dir/.forcegate-options" 2>/dev/null)" = "$options" ]; then return 0; fi
  rm -f "$dir/.forcegate-options"
  cmake -S . -B "$dir" -G Ninja "$@" || return
  printf '%s' "$options" >"$dir/.forcegate-options"
}

# worse_code A B: the exit code of two gates. A rejection is never hidden, and a rig fault (4, the only one that is worth a retry)
# only stands where the other one has nothing to say.
worse_code() {
  if [ "$1" -eq 1 ] || [ "$2" -eq 0 ]; then echo "$1"
  elif [ "$2" -eq 1 ] || [ "$1" -eq 0 ] || [ "$1" -eq 4 ]; then echo "$2"
  else echo "$1"; fi
}
