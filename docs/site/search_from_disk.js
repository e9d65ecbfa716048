// Opened from a disk a page may start no worker: then the worker's script runs in a hidden frame.
if (location.protocol === 'file:') {
  // As between a page and its worker a message comes later, and as a copy.
  const send = (data, target) => {
    const copy = structuredClone(data);
    setTimeout(() => target.onmessage?.({ data: copy }));
  };

  globalThis.Worker = class {
    onmessage = null;
    #frame = document.createElement('iframe');
    #ready;

    constructor(address) {
      this.#frame.hidden = true;
      document.body.append(this.#frame);
      const inside = this.#frame.contentWindow;
      inside.postMessage = (data) => send(data, this);
      const script = inside.document.createElement('script');
      script.src = new URL(address, location.href).href;
      this.#ready = new Promise((resolve) => script.addEventListener('load', resolve));
      inside.document.body.append(script);
    }

    async postMessage(data) {
      await this.#ready;
      send(data, this.#frame.contentWindow ?? {});
    }

    terminate() {
      this.#frame.remove();
    }
  };
}
