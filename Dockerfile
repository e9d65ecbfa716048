# The dashboard as an image: docs/deploy.md says how it is built and run. It runs as a user without
# rights, on a file system that may be read-only: it writes to /data and /tmp alone.

FROM python:3.13-slim AS build
WORKDIR /build
COPY requirements.lock .ci/runtime_lock.py ./
# Versions alone: pip takes no hashes for what it chooses by itself. The second step checks them.
RUN sed -n 's/^\([a-z0-9][^ ]*==[^ ]*\)\( ; [^\\]*\)\{0,1\}.*/\1\2/p' requirements.lock > versions.txt
RUN pip install --dry-run --ignore-installed --quiet --report tools.json \
      --constraint versions.txt hatchling \
    && python runtime_lock.py tools.json requirements.lock > tools.lock \
    && python -m venv tools \
    && tools/bin/pip install --no-cache-dir --no-deps --require-hashes --requirement tools.lock
COPY pyproject.toml README.md LICENSE CHANGELOG.md ./
COPY robot robot
COPY server server
COPY web web
COPY presets presets
COPY slidetune slidetune
RUN tools/bin/python -m hatchling build -t wheel -d wheel
# Of the lock what this wheel needs here, each download with its hash; then the wheel itself.
RUN pip install --dry-run --ignore-installed --quiet --report wheel.json \
      --constraint versions.txt wheel/*.whl \
    && python runtime_lock.py wheel.json requirements.lock > runtime.lock \
    && python -m venv /opt/slidetune \
    && /opt/slidetune/bin/pip install --no-cache-dir --no-deps --require-hashes --requirement runtime.lock \
    && /opt/slidetune/bin/pip install --no-cache-dir --no-deps --no-index wheel/*.whl

FROM python:3.13-slim
# Pinocchio leaves one library to the system.
RUN apt-get update \
    && apt-get install --yes --no-install-recommends libgomp1 \
    && rm -rf /var/lib/apt/lists/* \
    && useradd --system --uid 10001 --no-create-home --home-dir /data slidetune \
    && install --directory --owner slidetune --group slidetune /data
COPY --from=build /opt/slidetune /opt/slidetune
ENV PATH=/opt/slidetune/bin:$PATH \
    PYTHONDONTWRITEBYTECODE=1 \
    XDG_CACHE_HOME=/opt/slidetune/cache \
    XDG_DATA_HOME=/data
# The control laws, compiled here: the first start takes seconds, also where the image can't be written.
RUN python -c "from slidetune.robot.loop.warmup import warm_up, warm_up_arm; warm_up(); warm_up_arm('pendulum'); warm_up_arm('two_links')"
USER 10001
WORKDIR /data
VOLUME /data
EXPOSE 8000
# Without a token the answer is 401: the server is there, and asks for it.
HEALTHCHECK --interval=30s --timeout=5s --start-period=90s --retries=3 \
  CMD ["python", "-c", "import http.client, sys; asked = http.client.HTTPConnection('127.0.0.1', 8000, timeout=4); asked.request('GET', '/api/health'); sys.exit(asked.getresponse().status not in (200, 401))"]
ENTRYPOINT ["slidetune"]
# Any address but loopback asks for a token: it is part of the address in the log.
CMD ["serve", "--host", "0.0.0.0", "--port", "8000", "--no-browser"]
