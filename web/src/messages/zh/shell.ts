// The frame of every page, in Simplified Chinese.

export const shell = {
  title: 'Leafcutter',
  skip: '跳到正文',
  nav: { label: '主菜单', jobs: '任务', queue: '队列', machines: '机器', materials: '材料', settings: '设置' },
  dismiss: '关闭',
  save: '保存',
  cancel: '取消',
  close: '关闭',
  edit: '修改',
  remove: '删除',
  add: '添加',
  connection: {
    idle: '正在连接',
    connecting: '正在连接',
    live: '已连接',
    waiting: '连接中断，正在重试',
    resting: '休眠中',
  },
  problem: {
    unreachable: 'Leafcutter 没有响应。它还在运行吗？',
    stale: '此页面比服务旧，请重新加载。',
    notYet: '此服务不提供该功能。',
    title: '操作失败',
    stop: (name: string) => `停止命令未到达 ${name}。请使用机器上的开关。`,
  },
  stop: {
    button: '停止',
    all: '所有机器',
    none: '没有已连接的机器。',
    hint: 'Ctrl + . 或连按两次 Esc 停止所有机器',
    sent: (name: string) => `已向 ${name} 发送停止。`,
  },
  view: { zoomIn: '放大', zoomOut: '缩小' },
};
