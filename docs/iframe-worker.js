// The search runs in a worker, which browsers refuse to pages that are opened as files: there it runs in a hidden frame.
if (location.protocol === "file:") {
  window.Worker = class IFrameWorker extends EventTarget {
    constructor(url) {
      super();
      const frame = document.createElement("iframe");
      frame.hidden = true;
      document.body.append(frame);
      this.window = frame.contentWindow;
      this.window.IFrameWorker = IFrameWorker;
      this.loaded = new Promise(resolve => { this.window.loaded = resolve; });
      this.window.document.write(`<body><script>
        postMessage = data => parent.postMessage(data, "*");
        importScripts = async (...urls) => {
          for (const url of urls) await new Promise(resolve => {
            document.body.append(Object.assign(document.createElement("script"), {src: url, onload: resolve}));
          });
        };
      <\/script><script src="${url}" onload="loaded()"><\/script>`);
      this.window.document.close();
      addEventListener("message", ({source, data}) => {
        if (source === this.window) this.dispatchEvent(new MessageEvent("message", {data}));
      });
    }
    postMessage(data) {
      this.loaded.then(() => this.window.dispatchEvent(new MessageEvent("message", {data})));
    }
  };
}
