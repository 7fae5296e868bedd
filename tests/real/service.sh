# Starts the service for the scripts beside this file, which source it at the root of the repository.
#
# program              the service: TOOLPATHD where it is set, else a debug build
# start_service FLAGS  starts it on a free port. Sets `address`, which is http://HOST:PORT, and `service`, its process,
#                      which the script has to kill at its end.
service=
program=${TOOLPATHD:-}
if [ -z "$program" ]; then
    cargo build --locked --quiet
    program=${CARGO_TARGET_DIR:-target}/debug/toolpathd
fi

start_service() {
    said=$(mktemp)
    "$program" --listen 127.0.0.1:0 --log warn "$@" >"$said" &
    service=$!
    waits=0
    address=
    while [ -z "$address" ] && [ "$waits" -lt 300 ] && kill -0 "$service" 2>/dev/null; do
        sleep 0.1
        waits=$((waits + 1))
        address=$(sed -n 's/^listening on //p' "$said")
    done
    if [ -z "$address" ]; then
        echo "the service $program did not start; its log stands above, and it printed:" >&2
        cat "$said" >&2
        exit 1
    fi
    rm "$said"
}
